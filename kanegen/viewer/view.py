"""`view`, the entry of the package, and `View`, the picture that it returns."""

from __future__ import annotations

import html
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

from numpy.typing import ArrayLike

from kanegen.c.templates import fill, raw
from kanegen.choices import did_you_mean
from kanegen.errors import OptionError, WriteError, counted, quoted
from kanegen.files import path_of, write_whole
from kanegen.model.system import System
from kanegen.viewer.live import Live
from kanegen.viewer.making import scene_of
from kanegen.viewer.motion import HasStates, Motion, motion_of
from kanegen.viewer.scene import Scene, embedded_json

HEIGHT = 520
"""Height of a picture in a notebook (pixels)."""


@dataclass(frozen=True, repr=False)
class View:
    """A picture of a system, as one page that needs neither a network nor a server.

    Attributes:
        system: The system.
        scene: What the picture shows.
        motion: Its coordinates over time; None for sliders.
        paths: Names of points, frames and bodies whose paths are drawn.

    Example:
        kg.view(system, trajectory).save("motion.html")
    """

    system: System
    scene: Scene
    motion: Motion | None = None
    paths: tuple[str, ...] = ()

    def __repr__(self) -> str:
        moves = "with a motion" if self.motion else "with sliders"
        return (
            f"<View of {self.scene.name}: {counted(len(self.scene.bodies) - 1, 'body', 'bodies')}, {moves}>"
        )

    def html(self, play: bool = False) -> str:
        """Return the page.

        Args:
            play: Whether it plays as soon as it is opened, unless the reader's system asks for less motion.

        Example:
            text = kg.view(system).html()
        """
        data = {
            "scene": self.scene.as_table(),
            "motion": self.motion.as_table() if self.motion else None,
            "subtitle": self._subtitle(),
            "paths": list(self.paths),
            "play": play,
        }
        return fill(
            "viewer/page.html",
            title=html.escape(self.scene.name),
            script=raw("viewer/viewer.js").rstrip(),
            data=embedded_json(data),
        )

    def save(self, path: str | os.PathLike[str], play: bool = True) -> None:
        """Write the page to a file, which any browser opens.

        Args:
            path: The file, whose name ends in .html.
            play: Whether it plays as soon as it is opened, unless the reader's system asks for less motion.

        Raises:
            WriteError: If `path` is no path, does not end in .html, or cannot be written.

        Example:
            kg.view(system).save("arm.html")
        """
        file = path_of(path)
        if file.suffix.lower() not in (".html", ".htm"):
            raise WriteError(f"{file}: a page ends in .html.")
        write_whole(file, self.html(play))

    def live(self, port: int = 8080, host: str = "127.0.0.1") -> Live:
        """Start a server whose page shows the picture with sliders, and which the program can move.

        Args:
            port: Port of the server; if it is taken, the next one that is free.
            host: Address on which it listens; by default only this machine can reach it.

        Raises:
            MissingError: If viser is not installed (`pip install 'kanegen[viewer]'`).
            OptionError: If the server cannot start.

        Example:
            with kg.view(system).live() as live:
                print(live.url)
                live.wait()
        """
        return Live(self.system, self.scene, self.motion, host, port)

    def _repr_html_(self) -> str:
        """Return the page in a frame, for notebooks."""
        page = html.escape(self.html(), quote=True)
        return (
            f'<iframe srcdoc="{page}" title="{html.escape(self.scene.name, quote=True)}" '
            f'style="width: 100%; height: {HEIGHT}px; border: 0"></iframe>'
        )

    def _subtitle(self) -> str:
        """Return how many bodies and coordinates there are, and the mass."""
        bodies = self.scene.bodies[1:]
        mass = sum(body.mass for body in bodies)
        count = counted(len(bodies), "body", "bodies")
        return f"{count} · {counted(len(self.scene.coordinates), 'coordinate')} · {mass:.4g} kg"


def view(
    system: System,
    trajectory: HasStates | Sequence[ArrayLike] | None = None,
    *,
    x: ArrayLike | Mapping[str, float] | None = None,
    paths: Iterable[str] = (),
    forces: Mapping[str, ArrayLike] | None = None,
    plots: Mapping[str, ArrayLike] | None = None,
) -> View:
    """Return a picture of a system: of a motion, or with a slider for every freedom.

    Args:
        system: The tree; parameters stand at their defaults.
        trajectory: The motion: what `simulate` or `Library.rollout` returns, or a pair of (T,) times (s) and
            (T, m) coordinates. None gives sliders.
        x: (m,) coordinates at which the sliders begin, all or some by name (rad, m, 1); the others are
        neutral.
        paths: Names of points, frames and bodies whose paths are drawn; a body's is that of its mass centre.
        forces: (T, 3), or (3,) where it does not change, inertial components of forces (N) that are drawn as
            arrows, by name of the point, frame or body on which each acts.
        plots: (T,) further quantities for the plot, by their names.

    Raises:
        OptionError: If `system` is none, `trajectory` is none or one of another model, an argument is given
            that needs a trajectory, or there is nothing of a name in `paths`.
        ArrayError: If an array has another shape, or a number in it is not finite.
        ModelError: If there is nothing of the name of a force.

    Example:
        kg.view(kg.load("models/eight_body.toml")).save("eight_body.html")
    """
    scene = scene_of(system, x)
    if trajectory is None:
        for name, given in (("paths", tuple(paths)), ("forces", forces), ("plots", plots)):
            if given:
                raise OptionError(f"{name}: only with a trajectory. Pass one, or leave {name} out.")
        return View(system, scene)
    if x is not None:
        raise OptionError("x: the motion has its own start. Leave x out, or the trajectory.")
    motion = motion_of(system, trajectory, forces, plots)
    names = _names(system, paths)
    return View(system, replace(scene, notes=[*scene.notes, *motion.notes]), motion, names)


def _names(system: System, paths: Iterable[str]) -> tuple[str, ...]:
    """Return the names of points, frames and bodies whose paths are drawn."""
    chosen = (paths,) if isinstance(paths, str) else tuple(paths)
    known = [*system.point_names, *system.frame_names]
    for name in chosen:
        if name not in known:
            raise OptionError(
                f"paths: there is no point, frame or body {quoted(name)}. {did_you_mean(name, known)}"
            )
    return chosen
