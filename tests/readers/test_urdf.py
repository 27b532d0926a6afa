"""URDF robots: names, order, exact numbers, warnings, and one message for each error."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import KanegenWarning, ModelError, ReadError
from kanegen.model.joint import IDENTITY
from kanegen.model.names import identifier
from kanegen.model.rotations import apply, normalized, rotation_quaternion, rotation_rpy, rotation_to_axis
from kanegen.model.system import System
from kanegen.readers import load
from tests.support.paths import EVERY_JOINT
from tests.support.urdf import BASE, axis, joint, link, origin

RIGHT = repr(math.pi / 2)


def read(folder: Path, inside: str, floating_base: bool = False, head: str = '<robot name="r">') -> System:
    path = folder / "r.urdf"
    path.write_text(f"{head}\n{inside}</robot>\n", encoding="utf-8")
    return load(path, floating_base)


def test_bodies_are_numbered_depth_first_in_the_order_of_the_file() -> None:
    system = load(EVERY_JOINT)
    assert system.name == "2dof-planar rig"
    assert [body.name for body in system.bodies] == ["plate", "arm", "wheel", "ball", "rod"]
    assert system.connection == (0, 1, 2, 2, 1)
    angles = ("plate.theta3", "swing", "roll", "ball.theta1", "ball.theta2", "ball.theta3")
    translations = ("plate.s1", "plate.s2", "ball.s1", "ball.s2", "ball.s3", "lift")
    assert system.freedom_names == angles + translations
    assert system.gravity == (0, 0, -9.81)
    assert not any(body.loads for body in system.bodies)


def test_fixed_and_floating_base(tmp_path: Path) -> None:
    text = link("base", 7) + link("stand", 2) + link("arm") + joint("j", "stand", "arm")
    text += joint("weld", "base", "stand", origin("0 0 1"), "fixed")
    (arm,) = read(tmp_path, text).bodies
    assert (arm.name, arm.lower, arm.mass, arm.joint.position) == ("arm", 0, 1, (0, 0, 1))
    base, arm = read(tmp_path, text, floating_base=True).bodies
    assert (base.name, base.lower, base.mass, base.joint.free) == ("base", 0, 9, (True,) * 6)
    assert base.mass_center == (0, 0, 2 / 9)
    assert (arm.lower, arm.joint.position) == (1, (0, 0, 1))


def test_basis_axes_keep_the_link_frame(tmp_path: Path) -> None:
    for k, xyz in enumerate(("1 0 0", "0 1 0", "0 0 2")):
        (body,) = read(tmp_path, BASE + link("a") + joint("j", "base", "a", axis(xyz))).bodies
        assert body.joint.free == tuple(i == k for i in range(6))
        assert (body.joint.orientation, body.joint.name) == (IDENTITY, "j")
    (body,) = read(tmp_path, BASE + link("a") + joint("j", "base", "a", kind="prismatic")).bodies
    assert body.joint.free == (False, False, False, True, False, False)


def test_right_angles_and_signed_axes_stay_exact(tmp_path: Path) -> None:
    text = BASE + link("a", 2, origin("0.1 0.2 0.3", f"0 0 {RIGHT}")) + link("b")
    text += joint("j", "base", "a", axis("0 0 -1") + origin("1 2 3", f"{RIGHT} 0 -{RIGHT}"))
    text += joint("k", "a", "b", axis("0 1 0") + origin("0.4 0.5 0.6"))
    a, b = read(tmp_path, text).bodies
    # Roll pi/2 then yaw -pi/2 takes the columns x, y, z to -y, z, -x; the half turn about x negates y and z.
    assert a.joint.orientation == ((0, -1, 0), (0, 0, -1), (1, 0, 0))
    assert a.joint.position == (1, 2, 3)
    assert a.mass_center == (0.1, -0.2, -0.3)
    assert a.inertia == ((4, 0, 0), (0, 3, 0), (0, 0, 5))
    assert b.joint.orientation == ((1, 0, 0), (0, -1, 0), (0, 0, -1))
    assert b.joint.position == (0.4, -0.5, -0.6)


def test_a_single_mass_keeps_every_bit(tmp_path: Path) -> None:
    text = BASE + link("a", 0.1, origin("0.1 0.7 0.3")) + '<link name="tip"/>'
    text += joint("j", "base", "a", axis("0 0 1")) + joint("w", "a", "tip", kind="fixed")
    (body,) = read(tmp_path, text).bodies
    assert (body.mass, body.mass_center) == (0.1, (0.1, 0.7, 0.3))
    assert body.inertia == ((3, 0, 0), (0, 4, 0), (0, 0, 5))


def test_lumping_by_hand(tmp_path: Path) -> None:
    """Point masses of 1 and 3 kg, 4 m apart, have 12 kg m^2 across their line and the mass centre at 3 m."""
    text = BASE + link("a", 1, inertia=(0, 0, 0)) + link("b", 3, inertia=(0, 0, 0))
    text += joint("j", "base", "a", axis("0 0 1")) + joint("w", "a", "b", origin("4 0 0"), "fixed")
    (body,) = read(tmp_path, text).bodies
    assert (body.mass, body.mass_center) == (4, (3, 0, 0))
    assert body.inertia == ((0, 0, 0), (0, 12, 0), (0, 0, 12))


def test_massless_links_and_cancelled_inertias(tmp_path: Path) -> None:
    noise = link("b", 0.5, origin("0 0 0.03"), (-5e-20, -5e-20, 0))
    text = BASE + '<link name="a"/>' + noise + joint("j", "base", "a") + joint("k", "a", "b")
    a, b = read(tmp_path, text).bodies
    assert (a.mass, a.mass_center) == (0, (0, 0, 0))
    assert a.inertia == b.inertia == ((0, 0, 0),) * 3
    small = BASE + link("b", 0.5, origin("0 0 0.03"), (1e-18, 1e-18, 1e-18)) + joint("j", "base", "b")
    assert read(tmp_path, small).bodies[0].inertia[0][0] == 1e-18


def test_rotations() -> None:
    half = math.sqrt(0.5)
    np.testing.assert_allclose(
        rotation_quaternion(0, 0, half, half), ((0, -1, 0), (1, 0, 0), (0, 0, 1)), atol=1e-15
    )
    assert (
        rotation_quaternion(0, 0, 3, 3)
        == rotation_rpy((0, 0, math.pi / 2))
        == ((0, -1, 0), (1, 0, 0), (0, 0, 1))
    )
    rng = np.random.default_rng(3)
    for v in [*rng.standard_normal((50, 3)).tolist(), (1, 1, -1), (-1e-9, 0, -1), (1e-300, -2e-300, 0)]:
        a = normalized((v[0], v[1], v[2]))
        i, b = rotation_to_axis(a)
        assert abs(a[i]) == max(map(abs, a))
        np.testing.assert_allclose(apply(b, a), np.eye(3)[i], atol=5e-16)
        np.testing.assert_allclose(np.array(b) @ np.array(b).T, np.eye(3), atol=1e-15)
        assert np.linalg.det(b) > 0


def test_a_mimic_joint_follows_another(tmp_path: Path) -> None:
    text = BASE + link("a") + link("b") + joint("j", "base", "a")
    system = read(tmp_path, text + joint("k", "a", "b", '<mimic joint="j" multiplier="2" offset="0.1"/>'))
    assert system.freedom_names == ("j",)
    assert system.coupled_names == ("k",)
    assert system.couplings == (kg.Coupling("b.theta1", {"a.theta1": 2.0}, 0.1),)
    assert read(tmp_path, text + joint("k", "a", "b", '<mimic joint="j"/>')).couplings[0].pairs[0][1] == 1.0


def test_the_gripper_of_a_bug_report() -> None:
    """The right finger mirrors the left one, whose travel an offset shifts."""
    library = kg.build(
        load(EVERY_JOINT.parent / "from_reports" / "mimic.urdf"), ("mass_matrix", "forward_dynamics")
    )
    assert library.freedom_names == ("roll", "jl")
    x, y, tau = [0.3, 0.02], [0.5, 0.1], [0.01, 0.2]
    np.testing.assert_allclose(library.mass_matrix(x), np.diag([0.00176372, 0.06]), rtol=1e-12, atol=1e-18)
    found = library.forward_dynamics(x, y, tau)
    np.testing.assert_allclose(found, [31.1964091572, 3.3410833333], rtol=1e-10)


@pytest.mark.parametrize(
    ("joints", "message"),
    [
        ('<mimic joint="x"/>', r"r\.urdf:\d+: <mimic>: there is no joint 'x'\. Known are 'j', 'k'"),
        ('<mimic joint="k"/>', r"r\.urdf:\d+: <mimic>: joint 'k' follows 'k': a circle"),
        ('<mimic joint="j" multiplier="0"/>', r"r\.urdf:\d+: <mimic multiplier>: 0 leaves no motion"),
        ('<mimic joint="j" multiplier="two"/>', r"r\.urdf:\d+: .*'two'"),
        ("<mimic/>", r"r\.urdf:\d+: .*joint"),
    ],
)
def test_a_mimic_joint_that_cannot_follow(tmp_path: Path, joints: str, message: str) -> None:
    text = BASE + link("a") + link("b") + joint("j", "base", "a") + joint("k", "a", "b", joints)
    with pytest.raises(ReadError, match=message):
        read(tmp_path, text)


def test_mimic_of_joints_without_a_freedom_of_their_own(tmp_path: Path) -> None:
    text = BASE + link("a") + link("b") + joint("k", "a", "b", '<mimic joint="j"/>')
    with pytest.raises(ReadError, match=r"<mimic>: joint 'j' is to be followed, but is fixed"):
        read(tmp_path, text + joint("j", "base", "a", kind="fixed"))
    with pytest.raises(ReadError, match=r"'j' is to be followed, but is planar and has 3 freedoms"):
        read(tmp_path, text + joint("j", "base", "a", kind="planar"))
    text = BASE + link("a") + link("b") + joint("j", "base", "a", '<mimic joint="k"/>')
    with pytest.raises(ReadError, match=r"<mimic>: joint 'j' follows 'k' follows 'j': a circle"):
        read(tmp_path, text + joint("k", "a", "b", '<mimic joint="j"/>'))
    with pytest.warns(KanegenWarning, match=r"these joints are fixed, so their <mimic> says nothing: k\."):
        text = BASE + link("a") + link("b") + joint("j", "base", "a")
        read(tmp_path, text + joint("k", "a", "b", '<mimic joint="j"/>', kind="fixed"))


def test_names_are_those_of_the_file(tmp_path: Path) -> None:
    text = BASE + link(" /a b ") + link("static") + link("a/b") + link("a_b")
    text += joint("l::x..y (1)", "base", "/a b") + joint("-k", "/a b", "static")
    text += joint("x", "static", "a/b") + joint("y", "static", "a_b")
    system = read(tmp_path, text, head='<robot name="int">')
    assert (system.name, system.identifier) == ("int", identifier("int"))
    assert system.freedom_names == ("l::x..y (1)", "-k", "x", "y")
    assert [body.name for body in system.bodies] == ["/a b", "static", "a/b", "a_b"]


def test_details_of_real_files(tmp_path: Path) -> None:
    text = f"<x:y/><!-- note --><gazebo><joint name='j'/></gazebo>{BASE}{link('a')}{joint('j', 'base', 'a')}"
    head = '\ufeff<?xml version="1.0" encoding="ISO-8859-1"?>\r\n<robot name="r" xmlns:x="http://a/b">'
    with pytest.warns(KanegenWarning, match=r"this is not read: <x:y> in <robot> \(line 3\)\.$"):
        assert read(tmp_path, text, head=head).freedom_names == ("j",)


def test_a_long_chain(tmp_path: Path) -> None:
    count = 3000
    text = "".join(link(f"l{k}") for k in range(count))
    text += "".join(joint(f"j{k}", f"l{k - 1}", f"l{k}", kind="fixed") for k in range(1, count))
    (body,) = read(tmp_path, text, floating_base=True).bodies
    assert body.mass == count


TWO = BASE + link("a")
GOOD = TWO + joint("j", "base", "a")


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ("\n<link>", r":3: not well-formed XML: mismatched tag: <link> of line 3 is not closed\."),
        ("", r":1: the robot has no <link>\."),
        (BASE, r":1: no joint of this robot moves\."),
        (TWO + joint("j", "base", "a", kind="fixed"), r":1: no joint of this robot moves\."),
        ('<link mass="0"/>', r':2: <link> lacks the attribute name="\.\.\."\.'),
        (BASE + "\n" + BASE, r":3: link 'base' exists already, at .*r\.urdf:2\. Rename one\."),
        (GOOD + link("b") + joint("j", "a", "b"), r": joint 'j' exists already, at "),
        (
            TWO + joint("j", "base", "aa"),
            r"child link 'aa' of joint 'j' does not exist\. Known are 'base', 'a'\.",
        ),
        (
            TWO + joint("j", "world", "a"),
            r"parent link 'world' of joint 'j' does not exist\. Known are 'base', 'a'",
        ),
        (GOOD + joint("k", "base", "a"), r"link 'a' has two parents, by the joints 'j' and 'k'\."),
        (GOOD + joint("k", "a", "base"), r"the joints form a loop: 'base' on 'a' on 'base'\."),
        (GOOD + link("b") + joint("k", "b", "b"), r"the joints form a loop: 'b' on 'b'\."),
        (GOOD + link("b"), r":1: several links have no parent: 'base', 'b'\."),
        (
            TWO + joint("j", "base", "a", kind="revolut"),
            r"unknown type 'revolut'\. Did you mean 'revolute'\?",
        ),
        (
            TWO + joint("j", "base", "a", kind="screw"),
            r"unknown type 'screw'\. Known are 'revolute', 'continuous', ",
        ),
        (TWO + '<joint name="j"/>', r'<joint> lacks the attribute type="\.\.\."\.'),
        (TWO + '<joint name="j" type="fixed"/>', r"<joint> lacks <parent>\."),
        (TWO + joint("j", "base", "a", axis("0 0 0")), r"the axis is zero: it has no direction\."),
        (TWO + joint("j", "base", "a", axis("0 1")), r'<axis xyz="0 1">: expected 3 numbers\.'),
        (TWO + joint("j", "base", "a", axis("0 1 x")), r"<axis xyz>: 'x' is not a finite number\."),
        (TWO + joint("j", "base", "a", axis("0 1 nan")), r"<axis xyz>: 'nan' is not a finite number\."),
        (TWO + joint("j", "base", "a", axis("0 1 1_0")), r"<axis xyz>: '1_0' is not a finite number\."),
        (
            TWO + joint("j", "base", "a", origin("0 0 1e999")),
            r"<origin xyz>: '1e999' is not a finite number\.",
        ),
        (
            TWO + joint("j", "base", "a", origin("0 0 ${h}")),
            r"'0 0 \$\{h\}' is a xacro expression\. Run xacro",
        ),
        (
            TWO + joint("j", "base", "a", origin() + "\n" + origin()),
            r":\d: <joint> holds a second <origin>\.",
        ),
        (
            TWO + joint("j", "base", "a", '<origin rpy="0 0 0" quat_xyzw="0 0 0 1"/>'),
            r"both rpy and quat_xyzw",
        ),
        (TWO + joint("j", "base", "a", '<origin quat_xyzw="0 0 0 0"/>'), r"a quaternion of zeros"),
        ("<xacro:include filename='x'/>" + GOOD, r":2: <xacro:include> is a xacro instruction\. Run xacro"),
        (link("a", -1), r":2: mass -1\.0 kg is negative\."),
        ('<link name="a"><inertial/></link>', r":2: <inertial> lacks <mass>\."),
        ('<link name="a"><inertial><mass value="1"/></inertial></link>', r"<inertial> lacks <inertia>\."),
        (
            BASE + link("a", 1, "", (3, 4, -5)) + joint("j", "base", "a"),
            r"body 'a': inertia is not positive semid",
        ),
        (
            GOOD
            + link("b", 1e308)
            + link("c", 1e308)
            + joint("k", "a", "b")
            + joint("w", "b", "c", "", "fixed"),
            r":\d+: body 'b': mass: inf is not finite",
        ),
        (GOOD + "&lt;&secret;", r":\d+: not well-formed XML: undefined entity\."),
        (
            BASE + link("x" * 10_001) + joint("j", "base", "a"),
            r":2: name of this <link>: 'x+\.\.\.x+' is longer than 10000 characters\.",
        ),
        (
            TWO + joint("j&#9;", "base", "a") + joint("a\u202eb", "base", "a"),
            r":3: name of this <joint>: 'a\\u202eb' contains the invisible character U\+202E\. Delete it\.",
        ),
    ],
)
def test_errors(tmp_path: Path, inside: str, message: str) -> None:
    with pytest.raises(ReadError, match=message) as caught:
        read(tmp_path, inside)
    assert str(caught.value).startswith(f"{tmp_path / 'r.urdf'}:")


def test_no_document_types_and_no_other_roots(tmp_path: Path) -> None:
    path = tmp_path / "r.urdf"
    path.write_text(
        '<?xml version="1.0"?>\n<!DOCTYPE r [<!ENTITY a SYSTEM "file:///etc/passwd">]>\n<r>&a;</r>'
    )
    with pytest.raises(ReadError, match=r"r\.urdf:2: a document type declaration .* it is not accepted"):
        load(path)
    path.write_text("<sdf/>")
    with pytest.raises(ReadError, match=r"r\.urdf:1: the top element is <sdf>, but URDF files have <robot>"):
        load(path)
    path.write_text("")
    with pytest.raises(ReadError, match=r"r\.urdf:1: not well-formed XML: no element found"):
        load(path)
    path.write_text('\n<?xml version="1.0"?><robot/>')
    with pytest.raises(
        ReadError, match=r"r\.urdf:2: not well-formed XML: <\?xml \.\.\.\?> may only stand at"
    ):
        load(path)
    path.write_bytes(b"<robot name='\xe9'/>")
    with pytest.raises(ReadError, match=r"r\.urdf:1: byte 0xe9 is not UTF-8"):
        load(path)


def _hinge(limit: str, kind: str = "revolute") -> str:
    return f'<robot name="r">{BASE}{link("b")}{joint("j", "base", "b", axis("0 0 -1") + limit, kind)}</robot>'


@pytest.mark.parametrize(
    ("limit", "kind", "ends"),
    [
        ('<limit lower="-1.5" upper="2" velocity="3" effort="87"/>', "revolute", [-1.5, 2, 3, 87]),
        ('<limit lower="-inf" upper="+inf" velocity="inf"/>', "revolute", [-np.inf, np.inf, np.inf, np.inf]),
        ('<limit upper="0.4" velocity="0.1"/>', "prismatic", [0, 0.4, 0.1, np.inf]),
        ('<limit lower="-1" upper="1" velocity="3" effort="8"/>', "continuous", [-np.inf, np.inf, 3, 8]),
        ("", "revolute", [-np.inf, np.inf, np.inf, np.inf]),
    ],
)
def test_limits_are_those_of_the_coordinate(limit: str, kind: str, ends: list[float], tmp_path: Path) -> None:
    """The axis is -z, so the body frame is turned; the coordinate keeps its sign, and so do its limits."""
    path = tmp_path / "hinge.urdf"
    path.write_text(_hinge(limit, kind))
    found = load(path).limits
    assert [found.lower[0], found.upper[0], found.speed[0], found.effort[0]] == ends


def test_limits_that_leave_nothing_count_as_none(tmp_path: Path) -> None:
    path = tmp_path / "hinge.urdf"
    path.write_text(_hinge('<limit lower="0" upper="0" velocity="0" effort="0"/>'))
    with pytest.warns(KanegenWarning, match=r"taken for none: 'j' \(lower and upper, velocity, effort\)"):
        assert not load(path).limits


@pytest.mark.parametrize(
    ("limit", "message"),
    [
        ('<limit lower="1" upper="-1"/>', "lower=1.0 exceeds upper=-1.0"),
        ('<limit upper="1" velocity="-1"/>', "<limit velocity>: -1.0 is negative"),
        ('<limit upper="1" effort="-2"/>', "<limit effort>: -2.0 is negative"),
        ('<limit upper="pi"/>', "'pi' is not a finite number"),
        ('<limit upper="1"/><limit upper="1"/>', "holds a second <limit>"),
    ],
)
def test_a_wrong_limit_is_an_error_with_its_line(limit: str, message: str, tmp_path: Path) -> None:
    path = tmp_path / "hinge.urdf"
    path.write_text(_hinge(limit))
    with pytest.raises(ReadError) as caught:
        load(path)
    assert str(caught.value).startswith(f"{path}:2: ") and message in str(caught.value)


WELDED = (
    BASE
    + link("arm")
    + joint("swing", "base", "arm", origin("0 0 1") + axis("1 1 0"))
    + link("hand", 2)
    + joint("wrist", "arm", "hand", origin("0 0.5 0", f"{RIGHT} 0 0"), "fixed")
    + link("tool", 0.5)
    + joint("flange", "hand", "tool", origin("0 0 0.25"), "fixed")
    + link("camera")
    + joint("mast", "base", "camera", origin("0 1 2", f"0 0 {RIGHT}"), "fixed")
)
"""A robot whose only axis is no basis vector, with links on fixed joints above it and on its base."""


def test_every_link_and_joint_is_a_frame(tmp_path: Path) -> None:
    system = read(tmp_path, WELDED)
    assert set(system.frame_names) == {
        *("base", "arm", "hand", "tool", "camera"),
        *("swing", "wrist", "flange", "mast"),
    }
    bodies = {name: system.frame(name).body for name in system.frame_names}
    assert {name for name, k in bodies.items() if k == 0} == {"base", "camera", "mast"}


def test_frames_are_those_of_the_file(tmp_path: Path) -> None:
    """Where the joint is at zero every frame is where a product of origins puts it, whatever body has it."""
    system = read(tmp_path, WELDED)
    frames = system.values().frames
    turned = np.array(rotation_to_axis(normalized((1.0, 1.0, 0.0)))[1])
    assert frames["arm"].position == pytest.approx(np.zeros(3), abs=0)
    assert frames["arm"].rotation == pytest.approx(turned.T, abs=1e-15)
    about_x = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
    for name, position, rotation in (
        ("hand", (0, 0.5, 0), about_x),
        ("tool", (0, 0.25, 0), about_x),
        ("camera", (0, 1, 2), np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]])),
    ):
        frame, body = frames[name], np.eye(3) if name == "camera" else turned
        assert body.T @ frame.position == pytest.approx(np.array(position), abs=1e-15)
        assert frame.rotation @ body == pytest.approx(rotation, abs=1e-15)
    for joint_name, child in (("swing", "arm"), ("wrist", "hand"), ("flange", "tool"), ("mast", "camera")):
        assert frames[joint_name].rotation.tolist() == frames[child].rotation.tolist()
        assert frames[joint_name].position.tolist() == frames[child].position.tolist()


def test_a_body_in_its_link_frame_has_no_further_frame(tmp_path: Path) -> None:
    system = read(tmp_path, BASE + link("a") + joint("j", "base", "a", axis("0 1 0")))
    assert [frame.name for frame in system.frames] == ["base", "j"]


def test_a_name_of_a_link_and_of_a_joint_means_the_link(tmp_path: Path) -> None:
    text = BASE + link("a") + joint("a", "base", "a", origin("0 0 1")) + link("b") + joint("j", "a", "b")
    assert read(tmp_path, text).frame("a").body == 1
    text = text.replace('joint name="j"', 'joint name="base"')
    with pytest.warns(KanegenWarning, match="links and joints share names: 'base' means the link, not the"):
        system = read(tmp_path, text)
    assert system.frame("base").body == 0


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "hand.theta1",
            "there is no freedom 'hand.theta1'. 'hand' is fixed to body 'arm', at (0, 0.5, 0) m",
        ),
        ("flange", "there is no freedom 'flange'. 'flange' is fixed to body 'arm', at (0, 0.25, 0) m in"),
        ("camera.s1", "there is no freedom 'camera.s1'. 'camera' is fixed to the ground, at (0, 1, 2) m."),
    ],
)
def test_a_message_says_where_a_welded_link_is(name: str, message: str, tmp_path: Path) -> None:
    system = read(tmp_path, WELDED)
    with pytest.raises(ModelError) as caught:
        system.with_locked({name: 0.1})
    assert message in str(caught.value)
