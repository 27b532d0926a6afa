"""Content of robot files that is unknown or out of place: an error if mass or motion would be lost."""

from __future__ import annotations

import warnings
from collections import Counter
from itertools import islice, product
from pathlib import Path
from xml.etree import ElementTree

import pytest

import kanegen as kg
from kanegen.readers.urdf_vocabulary import ELEMENTS
from tests.support.paths import EVERY_JOINT, FROM_REPORTS
from tests.support.urdf import BASE, axis, joint, link, origin

GOOD = BASE + link("a").replace("\n", " ") + joint("j", "base", "a", axis("0 0 1"))


def read(folder: Path, inside: str, head: str = '<robot name="r">') -> kg.System:
    path = folder / "r.urdf"
    path.write_text(f"{head}\n{inside}</robot>\n", encoding="utf-8")
    return kg.load(path)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("unknown_Inertial", r":1: <Inertial>: write <inertial> in lower case\."),
        ("unknown_Origin", r":1: <Origin>: write <origin> in lower case\."),
        (
            "unknown_inertial_below_robot",
            r":1: <inertial> in <robot> would be lost\. <inertial> is an element inside <link>\.",
        ),
        (
            "unknown_mass_in_link",
            r":1: <mass> in <link> would be lost\. <mass> is an element inside <inertial>\.",
        ),
        (
            "unknown_joint_axis_attribute",
            r':1: <joint axis="0 0 1">: this attribute would be lost\. <axis> is an element inside <joint>\.',
        ),
        (
            "xacro_nested",
            r":6: <xacro:inertial_sphere> is a xacro instruction\. Run xacro on the file first\.",
        ),
    ],
)
def test_mass_and_motion_of_public_reports_do_not_disappear(name: str, message: str) -> None:
    with pytest.raises(kg.ReadError, match=f"{name}.urdf{message}$"):
        kg.load(FROM_REPORTS / f"{name}.urdf")


def test_a_loop_stays_open_with_a_warning() -> None:
    with pytest.warns(kg.KanegenWarning, match=r"<loop_joint> in <robot>: the loop stays open \(line 1\)\.$"):
        system = kg.load(FROM_REPORTS / "unknown_loop_joint.urdf")
    # Two links with 0.1 kg m^2 turn about z, and one has 1.3 kg at 0.5 m.
    assert kg.build(system).mass_matrix([0.3]) == pytest.approx(0.1 + 0.1 + 1.3 * 0.5**2, rel=1e-15)


TOOL = '<link name="tool">{}</link>' + joint("f", "a", "tool", kind="fixed")
MASS = '<mass value="1.3"/>'


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ("<Link name='x'/>", r":2: <Link>: write <link> in lower case\."),
        (
            "<links><link name='x'/></links>",
            r"<links> in <robot> is no part of URDF and would be lost\. Did you ",
        ),
        ('<part name="x"><inertial/></part>', r"<part> is no part of URDF: <inertial> in it would be lost\."),
        (
            '<drake:joint name="k" type="ball"><parent link="a"/><child link="b"/></drake:joint>',
            r"<drake:joint> is no part of URDF: <parent> in it would be lost\. <parent> is an el",
        ),
        (
            TOOL.format('<inertia ixx="1"/>'),
            r"<inertia> in <link> would be lost\. <inertia> is an element ins",
        ),
        (
            '<link name="x"><origin xyz="0 0 1"/></link>',
            r"<origin> in <link> would be lost\. <origin> is an element inside <joint> or <inertial>\.",
        ),
        (TOOL.format(f"<Mass/>{MASS}"), r"<Mass> in <link> would be lost\."),
        (
            TOOL.format(f"<inertal>{MASS}</inertal>"),
            r"<inertal> is no part of URDF: <mass> in it would be lo",
        ),
        (TOOL.format("<inertal/>"), r"<inertal> in <link> is no part of URDF .* Did you mean <inertial>\?"),
        (
            TOOL.format(f"<a><b><c>{MASS}</c></b></a>"),
            r"<a> is no part of URDF: <mass> in it would be lost\.",
        ),
        ('<link name="x" mass="2"/>', r'<link mass="2">: this attribute would be lost\. <mass> is '),
        (
            f'<link name="x"><inertial mass="2">{MASS}</inertial></link>',
            r'<inertial mass="2">: this attribute',
        ),
        (
            joint("k", "a", "b", '<orgin xyz="1 0 0"/>'),
            r"<orgin> in <joint> is no part .* Did you mean <origin>\?",
        ),
        (
            joint("k", "a", "b", '<pose xyz="1 0 0"/>'),
            r"<pose> in <joint> is no part of URDF and would be lost\.$",
        ),
        (joint("k", "a", "b", '<origin XYZ="1 0 0"/>'), r'<origin XYZ="1 0 0">: write xyz in lower case\.'),
        (
            joint("k", "a", "b", '<origin xyz="1 0 0" ypr="0 0 1"/>'),
            r'<origin ypr="0 0 1"> would be lost\. Write <origin xyz="\.\.\." rpy="\.\.\."/>\.',
        ),
        (
            joint("k", "a", "b", "<origin>0 0 1 0 0 0</origin>"),
            r"text '0 0 1 0 0 0' in <origin> would be lost\.",
        ),
        (
            joint("k", "a", "b", "<origin><xyz>0 0 1</xyz></origin>"),
            r"<xyz> in <origin> is no part of URDF and would be lost\. Write <origin xyz=",
        ),
        (
            joint("k", "a", "b", '<axis xyz="0 0 1" rpy="0 0 1"/>'),
            r'<axis rpy="0 0 1">: this attribute would be',
        ),
        (
            '<joint name="k" type="fixed" rpy="0 0 1"/>',
            r'<joint rpy="0 0 1">: this attribute would be lost\.',
        ),
        (
            '<link name="${x}"/>',
            r"^[^:]+:2: <link name>: '\$\{x\}' is a xacro expression\. Run xacro on the file first",
        ),
        ('<link name="$(arg x)"/>', r"'\$\(arg x\)' is a xacro expression\."),
        ("<visual><a><xacro:if/></a></visual>", r"<xacro:if> is a xacro instruction\. Run xacro"),
    ],
)
def test_mass_and_motion_are_not_lost(tmp_path: Path, inside: str, message: str) -> None:
    with pytest.raises(kg.ReadError, match=message):
        read(tmp_path, GOOD + inside)


@pytest.mark.parametrize("uri", ["http://www.ros.org/wiki/xacro", "http://ros.org/Xacro"])
def test_xacro_under_any_prefix(tmp_path: Path, uri: str) -> None:
    """Elements of other namespaces are only named, those of xacro are refused."""
    head = f'<robot name="r" xmlns:m="{uri}" xmlns:o="http://other.org">'
    with pytest.raises(kg.ReadError, match=r"r\.urdf:2: <m:property> is a xacro instruction\."):
        read(tmp_path, GOOD + '<m:property name="x" value="1"/>', head)
    with pytest.warns(kg.KanegenWarning, match=r"<o:property> in <robot> \(line 2\)"):
        read(tmp_path, GOOD + '<o:property name="x" value="1"/>', head)


@pytest.mark.parametrize(
    ("inside", "message"),
    [
        ("\n<group/>\n<group/>" + 3 * "<group a='b'/>", r"<group> in <robot> \(lines 3, 4, 4 and 2 more\)\."),
        (
            '<link name="x"><foo/>half a text</link>',
            r"text in <link> \(line 2\), <foo> in <link> \(line 2\)\.",
        ),
        ('<link name="x" concave="yes"/>', r"attribute concave of <link> \(line 2\)\."),
        (
            joint("k", "a", "x", '<dynamics damping="0" K="7000"/><limits/>', "fixed") + '<link name="x"/>',
            r"attribute K of <dynamics> \(line 2\), <limits> in <joint> \(line 2\)\.",
        ),
        (
            joint("k", "a", "x", '<joint_properties damping="1"/>', "fixed") + '<link name="x"/>',
            r"<joint_properties> in <joint>: damping and friction stand in <dynamics> \(line 2\)\.",
        ),
        (
            '<gazebo><turnGravityOff>true</turnGravityOff><dampingFactor value="0.1"/></gazebo>',
            r"<turnGravityOff> in <gazebo> \(line 2\), <dampingFactor> in <gazebo> \(line 2\)\.",
        ),
        (
            '<gazebo reference="b"><inertial><mass>3</mass></inertial></gazebo>'
            "<gazebo><link><inertial/></link></gazebo>",
            r"<inertial> in <gazebo> \(lines 2, 2\)\.",
        ),
    ],
)
def test_other_content_is_named_once(tmp_path: Path, inside: str, message: str) -> None:
    """One warning names every kind with its first lines, and the equations are those of the rest."""
    if '<link name="x"' in inside and "<joint" not in inside:
        inside += joint("k", "a", "x", kind="fixed")
    with pytest.warns(kg.KanegenWarning, match=rf"r\.urdf: this is not read: .*{message}$") as caught:
        system = read(tmp_path, GOOD + inside)
    assert len(caught) == 1
    assert system.bodies == read_quietly(tmp_path, GOOD).bodies


def read_quietly(folder: Path, inside: str) -> kg.System:
    with warnings.catch_warnings(action="error"):
        return read(folder, inside)


@pytest.mark.parametrize(
    "inside",
    [
        '<material name="m"/><transmission><joint name="j"/><mass/></transmission>',
        '<sensor><parent link="a"/></sensor>',
        "<gazebo><static>false</static><springStiffness>0.0</springStiffness><mass>1</mass><x:y/></gazebo>",
        f'<link name="x" type="visual"><visual>{origin()}</visual><collision/>'
        f"<self_filter>{origin()}</self_filter>"
        '<gravity>1</gravity><origin xyz="0 0 0" rpy="0 -0 0"/></link>' + joint("k", "a", "x", kind="fixed"),
        '<link name="x"/>'
        + joint(
            "k",
            "a",
            "x",
            '<axis xyz="0 0 0" rpy="0 0 0"/><calibration rising="0.1"/><joint_properties damping="0"/>'
            '<safety_controller k_velocity="3"/>'
            '<limit lower="0" upper="1" effort="1" velocity="1" current="3"/>',
            "fixed",
        ),
        '<ros2_control><joint name="j"/></ros2_control><mujoco><compiler meshdir="x"/></mujoco>',
        '<gazebo><plugin filename="$(find x)/${y}"><inertial/></plugin></gazebo>',
    ],
)
def test_what_has_no_effect_is_passed_over(tmp_path: Path, inside: str) -> None:
    assert read_quietly(tmp_path, GOOD + inside).bodies == read_quietly(tmp_path, GOOD).bodies


def test_long_names_and_deep_trees(tmp_path: Path) -> None:
    """Messages stay short and nothing recurses."""
    deep = "<a>" * 20_000 + "</a>" * 20_000
    with pytest.warns(kg.KanegenWarning, match=r"<a> in <robot> \(line 2\)"):
        read(tmp_path, GOOD + deep)
    with pytest.warns(kg.KanegenWarning) as caught:
        read(tmp_path, GOOD + "".join(f"<{'n' * 5000}{k}/>" for k in range(100)))
    assert len(str(caught[0].message)) <= 4000


def test_every_element_of_the_vocabulary_is_read_or_holds_what_is_read() -> None:
    for known in ELEMENTS.values():
        assert not set(known.children) & set(known.passed_over)
        assert set(known.children) <= ELEMENTS.keys()


READ = ("link", "inertial", "mass", "inertia", "joint", "origin", "axis", "parent", "child")
"""Elements without which the equations would be others."""


def misspelt(name: str) -> list[str]:
    """Return ways to write a name that are wrong."""
    swapped = name[0] + name[2] + name[1] + name[3:]
    return [name.capitalize(), name.upper(), name[:-1], name[1:], f"{name}s", swapped, f"x:{name}", "foo"]


def whole() -> ElementTree.Element:
    return ElementTree.fromstring(EVERY_JOINT.read_text().replace("sensor:camera", "camera"))


def refused_or_equal(robot: ElementTree.Element, path: Path) -> str:
    """Read a changed robot; it must be refused, or have the equations of the whole one."""
    ElementTree.ElementTree(robot).write(path)
    try:
        with warnings.catch_warnings(action="ignore", category=kg.KanegenWarning):
            found = kg.load(path)
    except kg.ReadError as error:
        assert str(error).startswith(f"{path}:")
        return "refused"
    assert found.bodies == kg.load(EVERY_JOINT).bodies, ElementTree.tostring(robot)
    return "equal"


def test_no_misspelt_element_is_lost(tmp_path: Path) -> None:
    """Every element of a robot, one at a time, in every misspelling: an error, or the same bodies."""
    counts = Counter()
    for place, element in enumerate(whole().iter()):
        for name in misspelt(element.tag) if element.tag in READ else ():
            robot = whole()
            next(islice(robot.iter(), place, None)).tag = name
            counts[refused_or_equal(robot, tmp_path / "r.urdf")] += 1
    assert counts["refused"] > 500
    assert counts["equal"] <= 30  # the axes of a fixed joint, and elements inside a <transmission>


def test_no_misspelt_attribute_is_lost(tmp_path: Path) -> None:
    counts = Counter()
    for place, element in enumerate(whole().iter()):
        for attribute in element.attrib if element.tag in READ else ():
            for name in misspelt(attribute):
                robot = whole()
                changed = next(islice(robot.iter(), place, None))
                if name not in changed.attrib:
                    changed.attrib[name] = changed.attrib.pop(attribute)
                    counts[refused_or_equal(robot, tmp_path / "r.urdf")] += 1
    assert counts["refused"] > 700
    assert counts["equal"] <= 60  # zeros, the axis of a fixed joint, and elements inside a <transmission>


def test_no_misplaced_element_is_lost(tmp_path: Path) -> None:
    """Every element of a robot, one at a time, moved out of its parent or into its neighbour."""
    counts = Counter()
    count = sum(1 for _ in whole().iter())
    for place, further in product(range(1, count), (False, True)):
        robot = whole()
        every = list(robot.iter())
        parents = {child: parent for parent in every for child in parent}
        moved = every[place]
        outer = parents.get(parents[moved])
        siblings = list(parents[moved])
        inner = siblings[siblings.index(moved) - 1]
        target = inner if further else outer
        if moved.tag in READ and target is not None and target is not moved:
            parents[moved].remove(moved)
            target.append(moved)
            counts[refused_or_equal(robot, tmp_path / "r.urdf")] += 1
    assert counts["refused"] > 100
    assert counts["equal"] <= 20
