"""`WebPage`: motions in a browser by the C of several variants, beside a reference in double-double numbers.

A page holds formulations, of each of which there is a picture, and competitors, which are motions by the C of
one variant in one formulation. All make the same steps; their errors are distances between bodies, so that
competitors may have different coordinates.
"""

from __future__ import annotations

import html
import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from kanegen.browser.modules import PageModule
from kanegen.browser.starts import State
from kanegen.c.templates import fill, raw
from kanegen.errors import WriteError
from kanegen.files import path_of, write_whole
from kanegen.model.system import System
from kanegen.options import STRICT, TIERS, Variant
from kanegen.recursion.outputs.integrators import METHODS, RATES
from kanegen.viewer.scene import Scene, embedded_json

METHOD = "rk4"
"""The method of the steps of competitors unless another is given."""

REFERENCE = Variant(precision="double-double", storage="double-double", refinement=TIERS["exact"].refinement)
"""The variant whose rates the reference sums up."""

_SCRIPTS = ("evaluator.js", "double_double.js", "runners.js", "poses.js", "chart.js", "page.js")
"""Scripts of a page, in the order in which they define what later ones use."""

_HEIGHT = 640
"""Height of a page in a notebook (pixels)."""


@dataclass(frozen=True)
class Formulation:
    """A system in some coordinates and speeds, with its picture.

    Attributes:
        system: The tree.
        scene: Its picture.
        module: Positions of bodies and points, and energies, in double precision.
        places: Mass centres and joints among the points of `module`, where parameters may move them: number
            of the body, "center" or "joint", number of the body whose joint it is, and row.
    """

    system: System
    scene: Scene
    module: PageModule
    places: list[dict[str, Any]]

    @classmethod
    def of(cls, system: System, scene: Scene) -> Formulation:
        """Return a formulation with its module.

        Raises:
            OptionError, ModelError, BuildError: As `PageModule.of`.
        """
        marked, places = _marked(system.with_poses([body.name for body in system.bodies]))
        outputs = ("body_poses", "kinetic_energy", "potential_energy")
        points = ("point_positions",) if places else ()
        return cls(system, scene, PageModule.of(marked, (*outputs, *points), STRICT), places)


@dataclass(frozen=True)
class Competitor:
    """A motion by the C of one variant.

    Attributes:
        name: Its name.
        text: One sentence about it.
        formulation: Place of its formulation among those of the page.
        module: Its C in WebAssembly, with the functions of a step and of the rates.
        method: Name of the method of its steps, such as "rk4".
    """

    name: str
    text: str
    formulation: int
    module: PageModule
    method: str = METHOD

    @classmethod
    def of(
        cls, name: str, text: str, formulation: int, system: System, variant: Variant, method: str = METHOD
    ) -> Competitor:
        """Return a competitor whose module is generated and compiled.

        Raises:
            OptionError, ModelError, SingularError, BuildError: As `PageModule.of`.
        """
        module = PageModule.of(system, METHODS[method].functions[:1], variant)
        return cls(name, text, formulation, module, method)


@dataclass(frozen=True)
class Start:
    """A choice of states in which all motions begin.

    Attributes:
        name: Its name.
        states: The state in each formulation.
    """

    name: str
    states: Sequence[State]


@dataclass(frozen=True, repr=False)
class WebPage:
    """Motions of a system in a browser, as one page that needs neither a network nor a server.

    Attributes:
        title: Title of the page.
        subtitle: One line about the system.
        formulations: The systems that are drawn.
        competitors: The motions.
        reference: Place of the formulation of the reference, and its module.
        substeps: Steps of the reference for each step of the others.
        starts: States to choose from, the first at the beginning; a page with one has sliders.
        start_title: What the starts differ in.
        pictures: Places of the competitors in the pictures; None for the one that the reader chooses.
        step: Length of a step (s).
        notes: Sentences about the page.

    Example:
        kg.web(kg.load("models/double_pendulum.toml")).save("double_pendulum.html")
    """

    title: str
    subtitle: str
    formulations: Sequence[Formulation]
    competitors: Sequence[Competitor]
    reference: tuple[int, PageModule]
    substeps: int
    starts: Sequence[Start]
    start_title: str
    pictures: Sequence[int | None]
    step: float
    notes: Sequence[str]

    def __repr__(self) -> str:
        return f"<WebPage of {self.title}: {', '.join(one.name for one in self.competitors)}>"

    def html(self, play: bool = True) -> str:
        """Return the page.

        Args:
            play: Whether it moves as soon as it is opened, unless the reader's system asks for less motion.

        Example:
            text = kg.web(system).html()
        """
        return fill(
            "browser/page.html",
            title=html.escape(self.title),
            viewer=raw("viewer/viewer.js").rstrip(),
            style=raw("browser/page.css").rstrip(),
            scripts=[raw(f"browser/{name}").rstrip() for name in _SCRIPTS],
            data=embedded_json(self._table(play)),
        )

    def save(self, path: str | os.PathLike[str], play: bool = True) -> None:
        """Write the page to a file, which any browser of 2023 or later opens.

        Args:
            path: The file, whose name ends in .html.
            play: Whether it moves as soon as it is opened, unless the reader's system asks for less motion.

        Raises:
            WriteError: If `path` is no path, does not end in .html, or cannot be written; a file that was
                there before then stays as it is.

        Example:
            kg.web(system).save("arm.html")
        """
        file = path_of(path)
        if file.suffix.lower() not in (".html", ".htm"):
            raise WriteError(f"{file}: a page ends in .html.")
        write_whole(file, self.html(play))

    def _repr_html_(self) -> str:
        """Return the page in a frame, for notebooks."""
        page = html.escape(self.html(play=False), quote=True)
        return (
            f'<iframe srcdoc="{page}" title="{html.escape(self.title, quote=True)}" '
            f'style="width: 100%; height: {_HEIGHT}px; border: 0"></iframe>'
        )

    def _table(self, play: bool) -> dict[str, Any]:
        """Return what the script of the page reads."""
        formulation, reference = self.reference
        modules = [
            *(one.module for one in self.formulations),
            *(one.module for one in self.competitors),
            reference,
        ]
        behind = len(self.formulations)
        return {
            "title": self.title,
            "subtitle": self.subtitle,
            "modules": [module.as_table() for module in modules],
            "formulations": [
                {
                    "scene": one.scene.as_table(),
                    "module": place,
                    "places": one.places,
                    "freedoms": list(one.system.freedom_names),
                    "speeds": _speeds(one.system),
                }
                for place, one in enumerate(self.formulations)
            ],
            "competitors": [
                {
                    "name": one.name,
                    "text": one.text,
                    "formulation": one.formulation,
                    "module": behind + place,
                    "step": METHODS[one.method].functions[0],
                    "not_converged": one.module.not_converged,
                }
                for place, one in enumerate(self.competitors)
            ],
            "reference": {
                "name": "double-double",
                "text": "Arithmetic of about 32 digits, with which the others are compared.",
                "formulation": formulation,
                "module": len(modules) - 1,
                "substeps": self.substeps,
            },
            "parameters": _parameters(self.formulations[0].system),
            "starts": [
                {"name": start.name, "states": [{"x": one.x, "y": one.y} for one in start.states]}
                for start in self.starts
            ],
            "start_title": self.start_title,
            "pictures": list(self.pictures),
            "follows": _flies(self.formulations[0].system),
            "step": self.step,
            "play": play,
            "notes": list(self.notes),
        }


def reference_of(system: System) -> PageModule:
    """Return the module of the rates of a system in double-double arithmetic.

    Raises:
        OptionError, ModelError, SingularError, BuildError: As `PageModule.of`.
    """
    outputs = RATES[:1] if system.speeds_are_rates else RATES
    return PageModule.of(system, outputs, REFERENCE)


def _marked(system: System) -> tuple[System, list[dict[str, Any]]]:
    """Return a system with points at mass centres and joints, if parameters may move them, and their rows."""
    if not system.parameters:
        return system, []
    taken = {*system.point_names, *system.frame_names}
    points, places = {}, []
    for k, body in enumerate(system.bodies, start=1):
        found = [(k, "center", k, body.mass_center)]
        if body.lower:
            found.append((body.lower, "joint", k, body.joint.position))
        for number, kind, of, position in found:
            name = f"{kind} {of}"
            while name in taken:
                name += "_"
            points[name] = (system.bodies[number - 1].name, position)
            places.append((number, kind, of, name))
    marked = system.with_points(points)
    rows = {point.name: row for row, (_, point) in enumerate(marked.points)}
    return marked, [
        {"body": number, "kind": kind, "of": of, "row": rows[name]} for number, kind, of, name in places
    ]


def _speeds(system: System) -> list[dict[str, Any]]:
    """Return the speeds with the ranges of their sliders."""
    ranges = {"rad": 6.0, "m": 3.0}
    pairs = zip(system.speed_names, system.freedoms, strict=True)
    return [
        {
            "name": f"speed {name}",
            "unit": f"{freedom.unit}/s",
            "lower": -ranges[freedom.unit],
            "upper": ranges[freedom.unit],
        }
        for name, freedom in pairs
    ]


def _parameters(system: System) -> list[dict[str, Any]]:
    """Return the run-time parameters with the ranges of their sliders."""

    def ends(value: float) -> tuple[float, float]:
        if value == 0.0:
            return -1.0, 1.0
        near, far = 0.05 * value, 3.0 * value
        return min(near, far), max(near, far)

    return [
        {
            "name": one.name,
            "unit": "",
            "value": float(one.value),
            "lower": ends(one.value)[0],
            "upper": ends(one.value)[1],
        }
        for one in system.parameters
    ]


def _flies(system: System) -> bool:
    """Whether the first body moves in all directions, so that pictures follow it."""
    return all(system.bodies[0].joint.moving[3:])
