"""What a C file offers, as plain data: the facts of a model and the signatures of its functions."""

from __future__ import annotations

from dataclasses import dataclass

from kanegen.program.cut import cut, workspace_size
from kanegen.program.ir import EVALUATE, Array, Condition, Module, Program

PREPARE = "prepare"
"""The function that turns parameters into prepared constants."""

LARGEST = 8192
"""Numbers of one state that a batch keeps on the stack for every lane, 64 KiB a lane; with more it goes one
by one."""


@dataclass(frozen=True)
class ModelFacts:
    """What the code says about a model beside its programs.

    Attributes:
        name: A C identifier; the prefix of everything.
        freedom_names: n names in the order of {y}.
        freedom_units: Unit of each, "rad" or "m".
        coordinate_names: Names in the order of {x}; of the freedoms, or of four elements of a quaternion.
        coordinate_units: Unit of each, "rad", "m" or "1".
        speed_names: n names in the order of {y}; those of the coordinates whose rates they are, or others.
        body_names: N names.
        loaded: For each body whether it takes a force and a torque.
        freedom_bodies: n names of the bodies that the freedoms belong to.
        planar: By place in {x} of the middle angle of every joint whose three angles can come to lie in a
            plane, the function of it that is 0 there: "cos" or "sin".
        parameters: Name and default of each run-time parameter, in the order of the C array.
        legend: Names in the code and what they mean.
        points: Of each point its name and that of its body.
        loaded_points: For each point whether it takes a force and a moment.
        force_elements: What acts beside loads and gravity, a line each.
        poses: Names of the bodies that `body_poses` gives, in the order of its rows.
        reactions: Of each locked direction that `reaction_loads` gives, its name and the unit of its load.
        sequences: Of the bodies whose angles do not turn about the axes 1-2-3, name and sequence.
        prescribed: Of each prescribed freedom its name and its unit, "rad" or "m".
    """

    name: str
    freedom_names: tuple[str, ...]
    freedom_units: tuple[str, ...]
    coordinate_names: tuple[str, ...]
    coordinate_units: tuple[str, ...]
    body_names: tuple[str, ...]
    loaded: tuple[bool, ...]
    parameters: tuple[tuple[str, float], ...] = ()
    legend: tuple[tuple[str, str], ...] = ()
    freedom_bodies: tuple[str, ...] = ()
    planar: tuple[tuple[int, str], ...] = ()
    sequences: tuple[tuple[str, str], ...] = ()
    speed_names: tuple[str, ...] = ()
    points: tuple[tuple[str, str], ...] = ()
    loaded_points: tuple[bool, ...] = ()
    force_elements: tuple[str, ...] = ()
    poses: tuple[str, ...] = ()
    reactions: tuple[tuple[str, str], ...] = ()
    prescribed: tuple[tuple[str, str], ...] = ()

    @property
    def prescribed_names(self) -> tuple[str, ...]:
        """p names of the freedoms whose motion is an input."""
        return tuple(name for name, _ in self.prescribed)

    def unloaded(self, kind: str) -> dict[int, str]:
        """The rows of what takes no loads, "body" or "point", and what it is."""
        points = [name for name, _ in self.points]
        named = {"body": (self.body_names, self.loaded), "point": (points, self.loaded_points)}[kind]
        rows = enumerate(zip(*named, strict=True))
        return {row: f"{kind} {name!r}" for row, (name, is_loaded) in rows if not is_loaded}

    @property
    def has_quaternions(self) -> bool:
        """Whether {x} has more elements than {y}."""
        return len(self.coordinate_names) > len(self.freedom_names)

    @property
    def speeds(self) -> tuple[str, ...]:
        """For every place in {y} the name of a component of a velocity, or "" where it is the rate of {x}."""
        if not self.speed_names:
            return ("",) * len(self.freedom_names)
        pairs = zip(self.freedom_names, self.speed_names, strict=True)
        return tuple("" if speed == name else speed for name, speed in pairs)

    @property
    def takes_loads(self) -> bool:
        """Whether any body takes a force and a torque."""
        return any(self.loaded)


@dataclass(frozen=True)
class Function:
    """A C function, `<model>_<name>`, and its batch form.

    Attributes:
        name: Without the prefix.
        doc: One sentence.
        inputs: Arrays that it reads, in the order of the arguments.
        outputs: Arrays that it fills, which follow.
        shared: Names of inputs that all states of a batch have in common.
        spoilt: Names of outputs that hold only where some values are positive; the function then returns
            an int.
        workspace: Numbers that its pieces leave for each other, 0 if it is in one piece.
        judged: Names of outputs that may hold and not be accurate; the int that is returned then says so.
    """

    name: str
    doc: str
    inputs: tuple[Array, ...]
    outputs: tuple[Array, ...]
    shared: tuple[str, ...] = ()
    spoilt: tuple[str, ...] = ()
    workspace: int = 0
    judged: tuple[str, ...] = ()

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """What must be positive for `spoilt`."""
        return tuple(dict.fromkeys(array.condition for array in self.outputs if array.name in self.spoilt))

    @property
    def has_batch(self) -> bool:
        """Whether it depends on a state, so that many states make sense."""
        return self.name != PREPARE

    @property
    def in_lanes(self) -> bool:
        """Whether the batch form works on several states side by side, which its arrays must fit for."""
        return self.numbers <= LARGEST

    @property
    def numbers(self) -> int:
        """How many numbers it reads, fills and keeps between its pieces for one state."""
        arrays = (*self.inputs, *self.outputs)
        return self.workspace + sum(array.size for array in arrays if array.name not in self.shared)


def signatures(module: Module) -> dict[Function, tuple[Program, ...]]:
    """Every function of a module with its programs: `prepare` first, then the others in their order.

    A long function has several, its pieces; `prepare`, which runs once, always has one.
    """
    found: dict[Function, tuple[Program, ...]] = {}
    shared: tuple[str, ...] = ()
    if module.prepare is not None:
        arrays = _outputs(module.prepare)
        shared = tuple(array.name for array in arrays)
        doc = "Everything that depends on parameters alone. Call it again whenever a parameter changes."
        spoilt = _spoilt(module.prepare)
        found[Function(PREPARE, doc, module.prepare.inputs, arrays, spoilt=spoilt)] = (module.prepare,)
    for name, program in module.functions.items():
        arrays = _outputs(program)
        doc = f"{arrays[0].doc}."
        if len(arrays) > 1:
            doc = f"{_listed([array.name for array in arrays])} together, every intermediate shared."
        pieces = cut(program)
        between = workspace_size(pieces)
        watched = _spoilt(program), between, _judged(program)
        found[Function(name, doc, program.inputs, arrays, shared, *watched)] = pieces
    return found


def requested(module: Module) -> tuple[str, ...]:
    """The outputs that were asked for, each a function of its own."""
    return tuple(name for name in module.functions if name != EVALUATE)


def _outputs(program: Program) -> tuple[Array, ...]:
    return tuple(output.array for output in program.outputs)


def _spoilt(program: Program) -> tuple[str, ...]:
    return tuple(output.array.name for output in program.outputs if output.exists_if_positive)


def _judged(program: Program) -> tuple[str, ...]:
    return tuple(output.array.name for output in program.outputs if output.accurate_if_positive)


def _listed(names: list[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"
