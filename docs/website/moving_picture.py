"""Moving pictures as SVG with keyframes of CSS: small, sharp at any size, still for whoever wants no motion.

A shape that is an affine image of a circle, a square or a line stays one while its body moves, so each frame
is a matrix for each shape. Frames between which the others lie on straight lines are enough.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from kanegen.model.arguments import Floats
from kanegen.viewer.scene import Place, Scene, Shape
from kanegen.viewer.skeleton import JOINT

WIDTH, HEIGHT, MARGIN = 480, 320, 24
"""Size of a picture and its margin, in pixels."""

TOLERANCE = 0.6
"""Pixels by which a point may be off between two frames."""

FADE = 3.0
"""Per cent of the time in which a picture appears and vanishes."""

_GREY = {JOINT: "#6b7785"}
"""Colours that would vanish on a dark page, and what stands for them."""

_AXES = ("#d1495b", "#3a9d5d", "#3b7dd8")


@dataclass(frozen=True)
class Camera:
    """A view along parallel lines.

    Attributes:
        right: (3,) unit vector that points to the right of the picture, inertial components.
        up: (3,) unit vector that points upward in the picture.
    """

    right: Floats
    up: Floats

    @classmethod
    def of(cls, up: Sequence[float], toward: Sequence[float], height: float) -> "Camera":
        """Return the view of someone who looks along a horizontal direction, from `height` (rad) above it.

        Args:
            up: (3,) direction that is up.
            toward: (3,) direction from the viewer to the mechanism; its part along `up` does not count.
            height: Angle (rad) from which the viewer looks down.
        """
        upward = np.asarray(up, float) / np.linalg.norm(up)
        ahead = np.asarray(toward, float) - upward * (upward @ np.asarray(toward, float))
        ahead /= np.linalg.norm(ahead)
        return cls(np.cross(ahead, upward), np.cos(height) * upward + np.sin(height) * ahead)

    @property
    def matrix(self) -> Floats:
        """(2, 3): pixels to the right and downward of a unit length, before it is scaled."""
        return np.array([self.right, -self.up])


@dataclass(frozen=True)
class _Element:
    """A shape in the picture: what is drawn, and (T, 2, 3) affine maps of it, in metres."""

    drawing: str
    maps: Floats
    width: float = 0.0
    is_line: bool = False


def moving_svg(
    scene: Scene,
    seconds: float,
    rotations: Floats,
    origins: Floats,
    camera: Camera,
    traces: Sequence[Floats] = (),
    title: str = "",
) -> str:
    """Return the moving picture of a scene.

    Args:
        scene: Its bodies with their shapes.
        seconds: Time from the first frame to the last; frames are equally far apart.
        rotations: (T, N, 3, 3) rotations of the bodies, from inertial components to those of the body.
        origins: (T, N, 3) origins of the bodies, inertial components (m).
        camera: How it is looked at.
        traces: (T, 3) positions of points whose paths are drawn (m).
        title: What the picture shows, for those who do not see it.

    Example:
        moving_svg(scene_of(system), 5.0, rotations, origins, Camera.of((0, 0, 1), (0, 1, 0), 0.2))
    """
    elements = [
        element
        for k, body in enumerate(scene.bodies)
        for shape in body.shapes
        for element in _elements(
            replace(shape, color=_GREY.get(shape.color, shape.color)), *_poses(rotations, origins, k), camera
        )
    ]
    elements += [_spring(ends, rotations, origins, camera, scene.size) for ends in scene.springs]
    elements.sort(key=lambda element: element.is_line)
    paths = [trace @ camera.matrix.T for trace in traces]
    tripod = 0.12 * scene.size * np.vstack([np.zeros(3), np.eye(3)]) @ camera.matrix.T
    scale, shift = _fit(elements, [*paths, tripod])
    styles, drawings = [], []
    for i, element in enumerate(elements):
        maps = element.maps * scale
        maps[:, :, 2] += shift
        name = f"s{i}"
        styles.append(_keyframes(name, seconds, maps))
        width = f' stroke-width="{max(2.0, element.width * scale):.3g}"' if element.is_line else ""
        drawings.append(f'<{element.drawing}{width} class="{name}"/>')
    for i, path in enumerate(paths):
        style, drawing = _trace(f"t{i}", seconds, path * scale + shift)
        styles.append(style)
        drawings.insert(0, drawing)
    return _document(title, seconds, _axes(tripod * scale + shift), styles, drawings)


def _readable(shape: Shape) -> Shape:
    """Return a shape in a colour that shows on a light page and on a dark one."""
    return replace(shape, color=_GREY.get(shape.color, shape.color))


def _poses(rotations: Floats, origins: Floats, k: int) -> tuple[Floats, Floats]:
    """Return (T, 3, 3) rotations to inertial components and (T, 3) origins of body K; 0 is the ground."""
    if k:
        return np.swapaxes(rotations[:, k - 1], 1, 2), origins[:, k - 1]
    return np.broadcast_to(np.eye(3), (len(origins), 3, 3)), np.zeros((len(origins), 3))


def _elements(shape: Shape, turn: Floats, origin: Floats, camera: Camera) -> Iterator[_Element]:
    """Yield what is drawn of a shape."""
    center = (origin + turn @ np.asarray(shape.position)) @ camera.matrix.T
    axes = camera.matrix @ (turn @ np.reshape(shape.rotation, (3, 3)))
    if shape.kind in {"rod", "cylinder", "capsule"}:
        thickness, length = shape.size[0] * (1 if shape.kind == "rod" else 2), shape.size[1]
        if shape.kind == "cylinder":
            yield _ellipse(
                f'fill="{shape.color}" stroke="{shape.color}"', center, axes[:, :, :2] * shape.size[0]
            )
        cap = ' stroke-linecap="butt"' if shape.kind == "cylinder" else ""
        yield _line(f'stroke="{shape.color}"{cap}', center, axes[:, :, 2] * length, thickness)
    elif shape.kind == "box":
        yield from _faces(shape, center, axes)
    elif shape.kind != "mesh":
        radii = np.array(shape.size if len(shape.size) == 3 else shape.size[:1] * 3)
        yield _ellipse(f'fill="{shape.color}" stroke="{shape.color}"', center, axes * radii)


def _line(paint: str, center: Floats, along: Floats, width: float) -> _Element:
    x, y = np.moveaxis(along + 1e-6, -1, 0)
    start = center - along / 2
    maps = np.stack([np.stack([x, -y, start[:, 0]], -1), np.stack([y, x, start[:, 1]], -1)], 1)
    return _Element(f'path d="M0 0H1" {paint}', maps, width, is_line=True)


def _spring(
    ends: Sequence[Place], rotations: Floats, origins: Floats, camera: Camera, size: float
) -> _Element:
    """A spring between two points, which is stretched and keeps its width."""
    first, second = (
        (origin + turn @ np.asarray(end.position)) @ camera.matrix.T
        for end in ends
        for turn, origin in [_poses(rotations, origins, end.body)]
    )
    along = second - first + 1e-6
    across = along[:, ::-1] * [-1, 1] / np.linalg.norm(along, axis=1)[:, None] * (0.05 * size)
    coils = "".join(f"L{0.15 + 0.07 * i:.2f} {(-1) ** i}" for i in range(1, 10))
    maps = np.stack([along, across, first], 2)
    return _Element(f'path d="M0 0H.15{coils}L.85 0H1" fill="none" stroke="#8a94a3"', maps, is_line=True)


def _ellipse(paint: str, center: Floats, axes: Floats) -> _Element:
    """The outline of an ellipsoid: the image of the unit circle under the root of axes times axes."""
    values, vectors = np.linalg.eigh(axes @ np.swapaxes(axes, 1, 2))
    root = (vectors * np.sqrt(np.maximum(values, 0.0))[:, None, :]) @ np.swapaxes(vectors, 1, 2)
    return _Element(f'circle r="1" {paint}', np.concatenate([root, center[:, :, None]], 2))


def _faces(shape: Shape, center: Floats, axes: Floats) -> Iterator[_Element]:
    """The six faces of a box, as images of a square."""
    half = axes * (np.array(shape.size) / 2)
    for normal in range(3):
        sides = np.delete(half, normal, axis=2)
        for sign in (-1, 1):
            place = center + sign * half[:, :, normal]
            maps = np.concatenate([sides, place[:, :, None]], 2)
            yield _Element(f'path d="M-1 -1H1V1H-1Z" fill="{shape.color}" stroke="{shape.color}"', maps)


def _fit(elements: Sequence[_Element], paths: Sequence[Floats]) -> tuple[float, Floats]:
    """Return the scale (pixels per m) and the (2,) shift by which everything is inside the picture."""
    points = [path for path in paths]
    for element in elements:
        center, reach = element.maps[:, :, 2], np.linalg.norm(element.maps[:, :, :2], axis=2)
        points += [center + reach, center] if element.is_line else [center - reach, center + reach]
        if element.is_line:
            points[-2] = center + element.maps[:, :, 0]
    everything = np.concatenate(points)
    low, high = everything.min(0), everything.max(0)
    size = np.maximum(high - low, 1e-9)
    scale = float(min((WIDTH - 2 * MARGIN) / size[0], (HEIGHT - 2 * MARGIN) / size[1]))
    return scale, np.array([WIDTH, HEIGHT]) / 2 - scale * (low + high) / 2


def _kept(values: Floats, tolerance: float = TOLERANCE) -> list[int]:
    """Return the rows between which all others lie on straight lines, within a tolerance (pixels)."""
    kept, waiting = {0, len(values) - 1}, [(0, len(values) - 1)]
    while waiting:
        first, last = waiting.pop()
        share = np.linspace(0.0, 1.0, last - first + 1)[:, None]
        errors = np.abs(
            values[first : last + 1] - values[first] - share * (values[last] - values[first])
        ).max(1)
        worst = first + int(errors.argmax())
        if errors.max() > tolerance:
            kept.add(worst)
            waiting += [(first, worst), (worst, last)]
    return sorted(kept)


def _keyframes(name: str, seconds: float, maps: Floats) -> str:
    """Return the style of an element that (T, 2, 3) maps move, in pixels; one may only shift."""
    linear = np.abs(maps[:, :, :2] - maps[0, :, :2]).max() < TOLERANCE / 4
    values = maps[:, :, 2] if linear else maps.transpose(0, 2, 1).reshape(len(maps), 6)
    still = f"transform:matrix({_numbers(maps[0, :, :2].T.ravel())},0,0);" if linear else ""
    frame = "translate:{}px {}px".format if linear else (lambda *six: f"transform:matrix({','.join(six)})")
    rows = _kept(values)
    texts = {row: frame(*_numbers(values[row]).split(",")) for row in rows}
    if len(set(texts.values())) == 1:
        return f".{name}{{{still}{texts[0]}}}"
    last = len(maps) - 1
    frames = "".join(f"{_number(100 * row / last)}%{{{texts[row]}}}" for row in rows)
    animation = f"animation:{name} {seconds:g}s linear infinite"
    return f".{name}{{{still}{texts[0]};{animation}}}@keyframes {name}{{{frames}}}"


def _trace(name: str, seconds: float, path: Floats) -> tuple[str, str]:
    """Return the style and the drawing of a path that grows with time."""
    corners = path[_kept(path, TOLERANCE / 4)]
    travelled = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(path, axis=0), axis=1))])
    rows = _kept(travelled[:, None])
    last = len(path) - 1
    total = max(float(travelled[-1]), 1e-9)
    frames = "".join(
        f"{_number(100 * row / last)}%{{stroke-dashoffset:{_number(1 - travelled[row] / total, 4)}}}"
        for row in rows
    )
    style = f".{name}{{animation:{name} {seconds:g}s linear infinite}}@keyframes {name}{{{frames}}}"
    line = "L".join(f"{_number(x)} {_number(y)}" for x, y in corners)
    return style, f'<path d="M{line}" pathLength="1" stroke-dasharray="1" class="trace {name}"/>'


def _axes(tripod: Floats) -> str:
    """Return the inertial axes at the inertial origin."""
    start = f"M{_numbers(tripod[0])}L"
    return "".join(
        f'<path d="{start}{_numbers(end)}" stroke="{color}"/>'
        for end, color in zip(tripod[1:], _AXES, strict=True)
    )


def _numbers(values: Floats) -> str:
    return ",".join(_number(value) for value in values)


def _number(value: float, digits: int = 1) -> str:
    """Return a number of pixels or per cent, in as few characters as possible."""
    text = f"{value:.{digits}f}"
    text = text.rstrip("0").rstrip(".") if "." in text else text
    return {"-0": "0"}.get(text, text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text)


_STYLE = (
    "circle,path{vector-effect:non-scaling-stroke}"
    ".trace{vector-effect:none;fill:none;stroke:#d97706;stroke-opacity:.8}"
    ".all{animation:all @s linear infinite}"
    f"@keyframes all{{0%,to{{opacity:0}}{FADE:g}%,{100 - FADE:g}%{{opacity:1}}}}"
    "@media (prefers-reduced-motion:reduce){*{animation:none!important}}"
)


_PAINT = 'fill-opacity=".25" stroke-width="1.5" stroke-linecap="round" stroke-linejoin="round"'


def _document(title: str, seconds: float, axes: str, styles: Sequence[str], drawings: Sequence[str]) -> str:
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" role="img">',
            f"<title>{title}</title>",
            f"<style>{_STYLE.replace('@s', f'{seconds:g}s')}",
            *styles,
            "</style>",
            axes,
            f'<g class="all" {_PAINT}>',
            *drawings,
            "</g>",
            "</svg>",
            "",
        ]
    )
