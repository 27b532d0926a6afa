"""A live view: a picture that a running program moves, in the browser by viser."""

from __future__ import annotations

import base64
import io
import threading
import time
from contextlib import redirect_stdout
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import ArrayLike

from kanegen import extras
from kanegen.errors import OptionError
from kanegen.model.system import System
from kanegen.viewer.meshes import EXTRA
from kanegen.viewer.numbers import checked
from kanegen.viewer.poses import body_poses, wxyz
from kanegen.viewer.scene import MeshData, Scene, SceneCoordinate, Shape

if TYPE_CHECKING:
    from kanegen.viewer.motion import Motion

FRAMES = 30
"""Pictures a second while a motion plays."""


class Live:
    """A server on this machine whose page shows a system, with a slider for every freedom.

    It serves until `close` is called, the `with` block ends, or the program does.

    Attributes:
        port: Port of the server.

    Example:
        with kg.view(system).live() as live:
            live.set([0.1, 0.2])
            live.wait()
    """

    def __init__(self, system: System, scene: Scene, motion: Motion | None, host: str, port: int) -> None:
        self._system, self._scene, self._arrays = system, scene, system.values()
        self._trimesh = extras.module("trimesh", extra=EXTRA)
        viser = extras.module("viser", extra=EXTRA)
        try:
            with redirect_stdout(io.StringIO()):  # or viser draws a box of its own
                self._server: Any = viser.ViserServer(host=host, port=port, label=scene.name, verbose=False)
        except OSError as error:
            raise OptionError(
                f"port {port}: the server cannot start: {error}. Choose another port."
            ) from None
        self.port: int = self._server.get_port()
        self._host = host
        self._stopped = threading.Event()
        self._frames = [self._body(k) for k in range(len(scene.bodies))]
        self._make_ground()
        self._x = np.array(scene.start)
        self._prescribed = np.zeros(len(scene.prescribed))
        self._sliders = self._make_sliders()
        self._clock: Any = None
        self._place()
        if motion is not None:
            self._play(motion)

    @property
    def url(self) -> str:
        """Address of the page, for a browser on this machine."""
        return f"http://{self._host}:{self.port}"

    def set(self, x: ArrayLike, prescribed: ArrayLike | None = None) -> None:
        """Move the picture.

        Args:
            x: (m,) coordinates (rad, m, 1).
            prescribed: (p,) values of the prescribed freedoms (rad, m); as they were by default.

        Raises:
            ArrayError: If an array has another shape, or a number is not finite.

        Example:
            live.set(library.rollout(x, y, steps=10, step=1e-3).x[-1])
        """
        self._x = checked("x", x, self._x.shape)
        if prescribed is not None:
            self._prescribed = checked("prescribed", prescribed, self._prescribed.shape)
        for slider, value in zip(self._sliders, (*self._x, *self._prescribed), strict=True):
            slider.value = float(np.clip(value, slider.min, slider.max))
        self._place()

    def wait(self) -> None:
        """Serve until the program is interrupted (Ctrl-C), or another thread closes the view.

        Example:
            kg.view(system).live().wait()
        """
        try:
            while not self._stopped.wait(0.2):
                pass
        except KeyboardInterrupt:
            self.close()

    def close(self) -> None:
        """Stop the server; a second call does nothing.

        Example:
            live.close()
        """
        if not self._stopped.is_set():
            self._stopped.set()
            if self._clock is not None and self._clock is not threading.current_thread():
                self._clock.join()
            with redirect_stdout(io.StringIO()):
                self._server.stop()

    def __enter__(self) -> Self:
        """Return the view, which serves already."""
        return self

    def __exit__(self, *_: object) -> None:
        """Stop the server at the end of the block."""
        self.close()

    def _body(self, k: int) -> Any:
        """Add the shapes of body K below a frame, and return the frame, which moves them."""
        frame = self._server.scene.add_frame(f"/bodies/{k}", show_axes=False)
        body = self._scene.bodies[k]
        has_geometry = any(shape.role == "geometry" for shape in body.shapes)
        for i, shape in enumerate(body.shapes):
            if (shape.role == "geometry") == has_geometry:
                self._shape(f"/bodies/{k}/{i}", shape)
        return frame

    def _shape(self, name: str, shape: Shape) -> None:
        """Add a shape below the frame of its body."""
        vertices, faces = self._triangles(shape)
        self._server.scene.add_mesh_simple(
            name,
            vertices=vertices.astype(np.float32),
            faces=faces.astype(np.uint32),
            color=tuple(int(shape.color[i : i + 2], 16) for i in (1, 3, 5)),
            opacity=shape.opacity if shape.opacity < 1 else None,
            side="double",
            wxyz=wxyz(np.array(shape.rotation).reshape(3, 3)),
            position=np.array(shape.position),
        )

    def _triangles(self, shape: Shape) -> tuple[Any, Any]:
        """Return vertices and triangles of a shape."""
        make, size = self._trimesh.creation, shape.size
        if shape.kind == "mesh":
            vertices, faces = _decoded(self._scene.meshes[shape.mesh or 0])
            return vertices * size, faces
        made = {
            "box": lambda: make.box(size),
            "sphere": lambda: make.icosphere(subdivisions=3, radius=size[0]),
            "ellipsoid": lambda: make.icosphere(subdivisions=3),
            "cylinder": lambda: make.cylinder(size[0], size[1]),
            "rod": lambda: make.cylinder(size[0], size[1], sections=12),
            "capsule": lambda: make.capsule(height=size[1], radius=size[0]),
        }[shape.kind]()
        return made.vertices * (size if shape.kind == "ellipsoid" else 1.0), made.faces

    def _make_ground(self) -> None:
        """Add a grid below the first position, and look at it so that weights point down."""
        gravity = np.array(self._scene.gravity)
        up = -gravity / np.linalg.norm(gravity) if gravity.any() else np.array([0.0, 0.0, 1.0])
        self._server.scene.set_up_direction(tuple(up))
        _, origins = body_poses(self._arrays, self._scene.start, np.zeros(len(self._scene.prescribed)))
        size = self._scene.size
        across = np.linalg.qr(np.column_stack([up, np.eye(3)]))[0]
        turn = np.column_stack([across[:, 1], np.cross(up, across[:, 1]), up])
        middle = (origins.min(axis=0) + origins.max(axis=0)) / 2
        camera = self._server.initial_camera
        camera.position, camera.look_at = middle + turn @ (1.3 * size, -1.6 * size, 1.0 * size), middle
        camera.up = up
        self._server.scene.add_grid(
            "/ground",
            width=6 * size,
            height=6 * size,
            cell_size=0.25 * size,
            section_size=size,
            wxyz=wxyz(turn),
            position=up * (float((origins @ up).min()) - 0.1 * size),
        )

    def _make_sliders(self) -> list[Any]:
        """Add a slider for every coordinate and prescribed freedom."""
        found = []
        values = [*self._scene.start, *(0.0 for _ in self._scene.prescribed)]
        for one, value in zip((*self._scene.coordinates, *self._scene.prescribed), values, strict=True):
            slider = self._slider(one, value)
            slider.on_update(self._slid)
            found.append(slider)
        return found

    def _slider(self, one: SceneCoordinate, value: float) -> Any:
        """Add the slider of a coordinate, from its smallest to its largest value."""
        lower, upper = min(one.lower, value), max(one.upper, value)
        label = one.name if one.unit == "1" else f"{one.name}, {one.unit}"
        return self._server.gui.add_slider(
            label, min=lower, max=upper, step=(upper - lower) / 1000, initial_value=value
        )

    def _slid(self, event: Any) -> None:
        """Move the picture as a slider says that a person has moved."""
        if event.client is None:  # the program has moved it
            return
        values = [slider.value for slider in self._sliders]
        self._x, self._prescribed = np.split(np.array(values, np.float64), [len(self._x)])
        self._place()

    def _place(self) -> None:
        """Put all bodies where {x} puts them; a quaternion of zeros, no orientation, changes nothing."""
        with np.errstate(all="ignore"):
            rotations, origins = body_poses(self._arrays, self._x, self._prescribed)
        if not (np.isfinite(rotations).all() and np.isfinite(origins).all()):
            return
        with self._server.atomic():
            for frame, rotation, origin in zip(self._frames, rotations, origins, strict=True):
                frame.wxyz, frame.position = wxyz(rotation), origin

    def _play(self, motion: Motion) -> None:
        """Play a motion again and again, in a thread of its own, while a box is checked."""
        times, x, prescribed = motion.decoded()
        playing = self._server.gui.add_checkbox("play", initial_value=True)
        clock = self._server.gui.add_slider(
            "time, s",
            min=float(times[0]),
            max=float(times[-1]),
            step=float(times[-1] - times[0]) / 1000 or 1.0,
            initial_value=float(times[0]),
        )

        def show(moment: float) -> None:
            row = int(np.searchsorted(times, moment).clip(0, len(times) - 1))
            self.set(x[row], prescribed[row])

        def run() -> None:
            last = time.monotonic()
            while not self._stopped.wait(1 / FRAMES):
                now = time.monotonic()
                if playing.value:
                    later = clock.value + now - last
                    clock.value = later if later <= times[-1] else float(times[0])
                    show(clock.value)
                last = now

        clock.on_update(lambda event: show(clock.value) if event.client is not None else None)
        self._clock = threading.Thread(target=run, daemon=True)
        self._clock.start()


def _decoded(mesh: MeshData) -> tuple[Any, Any]:
    """Return the vertices (m) and the triangles of a mesh."""
    integers = np.frombuffer(base64.b64decode(mesh.vertices), "<u2").reshape(-1, 3)
    faces = np.frombuffer(base64.b64decode(mesh.faces), "<u2").reshape(-1, 3)
    return np.array(mesh.origin) + integers * np.array(mesh.step), faces
