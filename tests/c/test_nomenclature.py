"""The list of names at the head of generated code: exactly the names that occur, for every model."""

import re
from dataclasses import replace

import numpy as np
import pytest

import kanegen as kg
from kanegen.options import Variant
from kanegen.program.semantics import FLUSH, RELAXED
from kanegen.recursion.legend import Entry, entries, expression, legend, shown
from kanegen.recursion.meanings import FREEDOMS, MARKS, PLACES
from kanegen.recursion.outputs import INTEGRATORS, available
from tests.support import systems
from tests.support.cases import slow_among, slow_except
from tests.support.chains import hinges
from tests.support.paths import MODEL_FILES, MODELS

EQUATIONS = ("mass_matrix", "forcing")
SOLVERS = ("factorisation", "articulated bodies")
TYPES = "arithmetic_mode|double|float|long double|kanegen_double_double|simd|int"
LOCAL = re.compile(rf"^    (?:const )?(?:{TYPES}) ([^;\n()=]*?)((?: = [^\n]*)?);$", re.MULTILINE)
PRINTED = {
    "t1, t2, ...": r"t\d+_*",
    "sines, cosines": "sines|cosines",
    "half, sixth": "half|sixth",
    "square_1, factor_1, ...": r"(square|factor)_\d+",
}
ENDINGS = re.compile(f"_*(?:{'|'.join(expression(pattern).pattern for pattern, _ in MARKS)})$")
CONTROL = {"i", "rows", "valid", "within_margin", "carries", "found"}
"""Locals of loops and of the status of a batch, which need no explanation."""


def head(text):
    """Return the list of names: for names, places and freedoms, the meaning of each pattern."""
    comment = text[text.index("/*\n * Names, here") : text.index("#include")]
    found = {"Names": {}}
    section = "Names"
    for line in comment.splitlines()[2:]:
        if line.startswith((" * Places", " * Freedoms")):
            section = line.split()[1]
            found[section] = {}
        elif match := re.match(r" \*     (\S.*?)  +(\S.*)$", line):
            found[section][match[1]] = match[2]
    return found


def locals_of(source):
    """Return the names of the locals of all functions, read from the C."""
    name = source.model.name
    text = source.files[f"{name}.c"] + source.files[f"{name}_batch.c"]
    text = re.sub(r"\n        ", " ", text)
    declared = []
    for match in LOCAL.finditer(text):
        declared += [*match[1].split(","), *re.findall(r"= 0, (\w+)", match[2])]
    names = {re.sub(r"\[.*", "", one).strip() for one in declared}
    return {one for one in names if one and not one.endswith(("_rows", "_simd"))} - CONTROL


def expressions(lines):
    """Return the regular expression of every pattern."""
    known = {shown(entry.pattern): entry.regex for entry in entries()}
    known |= {shown(pattern): Entry(pattern, "").regex for pattern, _ in MARKS}
    return {line: known.get(line) or re.compile(PRINTED.get(line, re.escape(line))) for line in lines}


def check(source):
    """Check that every name has a line, and every line a name."""
    lines, names = head(source.files[f"{source.model.name}.c"]), locals_of(source)
    marks = {shown(pattern) for pattern, _ in MARKS}
    regexes = {line: regex for line, regex in expressions(lines["Names"]).items() if line not in marks}
    used = set()
    for name in names:
        stem = name
        while not any(regex.fullmatch(stem) for regex in regexes.values()):
            shorter = ENDINGS.sub("", stem)
            assert shorter != stem, f"{name} has no line"
            stem = shorter
        used |= {line for line, regex in regexes.items() if regex.fullmatch(stem)}
    assert used >= set(regexes), f"lines without a name: {set(regexes) - used}"
    for section, table in (("Places", PLACES), ("Freedoms", FREEDOMS)):
        for line in lines.get(section, {}):
            (regex,) = (Entry(*entry).regex for entry in table if shown(entry[0]) == line)
            assert any(regex.fullmatch(part) for name in names for part in name.split("_")), line


@pytest.mark.parametrize(
    "path", slow_among(MODEL_FILES, MODELS / "eight_body.toml"), ids=lambda path: path.stem
)
def test_names_of_the_equations(path):
    check(kg.generate(kg.load(path), EQUATIONS))


def test_names_of_long_chains():
    """Columns of [A] change to the fixed frame, and stay about one point while they pass several joints."""
    source = kg.generate(hinges(40), ("mass_matrix",))
    names = locals_of(source)
    assert all(any(name.startswith(first) for name in names) for first in ("q_", "d_", "l_"))
    check(source)


@pytest.mark.parametrize(
    "name",
    slow_except(
        ("quarter_car", "gantry_crane", "satellite", "free_body", "double_pendulum"),
        *("quarter_car", "double_pendulum"),
    ),
)
def test_names_of_all_outputs(name):
    system = kg.load(MODELS / f"{name}.toml")
    check(kg.generate(system, available(system)))


@pytest.mark.parametrize(
    ("speeds", "coordinates"),
    [("angle_rates", "angles"), ("angular_velocity", "angles"), ("angular_velocity", "quaternion")],
)
def test_names_of_speeds_and_coordinates(speeds, coordinates):
    outputs = ("mass_matrix", "forcing", "coordinate_rates", "forward_dynamics", "body_poses")
    system = kg.load(MODELS / "free_body.toml")
    check(kg.generate(system, outputs, speeds=speeds, coordinates=coordinates))


@pytest.mark.parametrize(
    "variant",
    [
        Variant(precision="float"),
        pytest.param(Variant(precision="long double"), marks=pytest.mark.slow),
        Variant(precision="double-double", refinement=1),
        pytest.param(Variant(storage="float"), marks=pytest.mark.slow),
        Variant(semantics=(*RELAXED, FLUSH)),
        Variant(solver="factorisation", refinement=2),
        Variant(solver="articulated bodies", refinement=1, without=("fold", "factor")),
    ],
    ids=lambda variant: f"{variant.precision}-{variant.solver}-{variant.storage}",
)
def test_names_of_precisions_and_solvers(variant):
    system = kg.load(MODELS / "six_revolute_arm.toml")
    check(kg.generate(system, ("forward_dynamics", "error_estimate", "regularity"), tier=variant))


EVERY = pytest.mark.parametrize(
    "every",
    [False, pytest.param(True, marks=pytest.mark.slow)],
    ids=["equations", "every output"],
)
"""Whether a source has every output that the system has, or its equations alone."""


@EVERY
@pytest.mark.parametrize("solver", slow_except(SOLVERS, "factorisation"))
def test_names_of_motors(solver, every):
    inertia, ratio = kg.Parameter("J", 0.003), kg.Parameter("n", 30.0)
    system = systems.chain(3, ["theta3"]).with_rotors(
        kg.Rotor("below", "body2.theta3", (1, 0.2, 0.3), inertia, ratio),
        kg.Rotor("above", "body3.theta3", (0, 1, 1), 0.001, ratio, "body3"),
    )
    outputs = available(system) if every else EQUATIONS
    check(kg.generate(system, outputs, tier=Variant(solver=solver, refinement=1)))


@EVERY
@pytest.mark.parametrize("solver", slow_except(SOLVERS, "articulated bodies"))
def test_names_of_couplings(solver, every):
    """Chains, several terms, a slide that follows angles, branches, motors, a spring, and a driven shaft."""
    system = systems.random_system(
        np.random.default_rng(3),
        5,
        connection=(0, 1, 2, 1, 0),
        free=systems.flags(5, ["theta2", "s1"]),
        loads=False,
    ).with_prescribed("body5.theta2")
    joint = replace(system.bodies[2].joint, armature=(0, 0.2, 0, 0.1, 0, 0))
    bodies = [replace(b, joint=joint) if k == 2 else b for k, b in enumerate(system.bodies)]
    system = replace(system, bodies=tuple(bodies)).with_couplings(
        kg.Coupling("body3.s1", {"body1.theta2": 0.1, "body5.theta2": 0.2}),
        kg.Coupling("body3.theta2", {"body4.theta2": kg.Parameter("a", -2.0)}, 0.3),
        kg.Coupling("body2.s1", {"body3.theta2": 0.5, "body5.s1": 1.0}),
    )
    system = system.with_force_elements(kg.JointSpring("body3.theta2", 3.0))
    outputs = [name for name in available(system) if "derivatives" not in name]
    check(kg.generate(system, outputs if every else EQUATIONS, tier=Variant(solver=solver, refinement=1)))


@pytest.mark.parametrize("refinement", slow_except((0, 1), 1))
@pytest.mark.parametrize("solver", slow_except(SOLVERS, "articulated bodies"))
def test_names_of_contacts(solver, refinement):
    """A floating body with a leg, held with its orientation, at a point, and in some directions."""
    floating = [False, True, False, True, True, True]
    system = systems.random_system(
        np.random.default_rng(3),
        4,
        connection=(0, 1, 2, 1),
        free=[floating, *systems.flags(3, ["theta2"])],
    )
    contacts = [
        kg.Contact("foot", frame="body3", damping=kg.Parameter("mu", 0.1)),
        kg.Contact("some", frame="body4", directions=("moment2", "force1", "force3"), damping=0.2),
    ]
    outputs = ("forward_dynamics", "contact_dynamics", "contact_forces", "error_estimate")
    check(
        kg.generate(
            system.with_contacts(contacts), outputs, tier=Variant(solver=solver, refinement=refinement)
        )
    )


@pytest.mark.parametrize("name", ["double_pendulum", "satellite"])
def test_names_of_steps(name):
    system = kg.load(MODELS / f"{name}.toml")
    names = [name for name, method in INTEGRATORS.items() if method.needs_further is not None]
    check(kg.generate(system, INTEGRATORS if system.speeds_are_rates else names))
    check(kg.generate(system, ("rollout_rk4",)))


def test_a_name_that_nobody_explains():
    assert legend(["hc_2a3_x", "omega_3", "omega_3_x_d4"]).unknown == ("omega_3",)
