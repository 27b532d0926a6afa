"""Elements of URDF files as text."""

from __future__ import annotations

BASE = '<link name="base"/>'


def link(name: str, mass: float = 1.0, origin: str = "", inertia: tuple[float, ...] = (3, 4, 5)) -> str:
    """Return a link with principal moments of inertia (kg m^2)."""
    xx, yy, zz = inertia
    return f"""<link name="{name}"><inertial>{origin}<mass value="{mass}"/>
        <inertia ixx="{xx}" iyy="{yy}" izz="{zz}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""


def joint(name: str, parent: str, child: str, inside: str = "", kind: str = "revolute") -> str:
    """Return a joint with further elements `inside`."""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>{inside}</joint>'
    )


def axis(xyz: str) -> str:
    """Return the axis of a joint."""
    return f'<axis xyz="{xyz}"/>'


def origin(xyz: str = "0 0 0", rpy: str = "0 0 0") -> str:
    """Return an origin by position (m) and roll, pitch, yaw (rad)."""
    return f'<origin xyz="{xyz}" rpy="{rpy}"/>'
