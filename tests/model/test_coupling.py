"""Couplings as part of a model: names, order, files, parameters, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import kanegen as kg
from kanegen.model.coordinates import Freedom
from tests.support.paths import MODELS


def arm() -> kg.System:
    """A chain of four hinges `a`, `b`, `c`, `d` about axis 3, whose last body also slides."""
    hinge = (False, False, True, False, False, False)
    bodies = [
        kg.Body(
            f"link{k}",
            k,
            1.0,
            ((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)),
            (0.2, 0, 0),
            kg.Joint((0.4, 0, 0), free=hinge if k < 3 else (*hinge[:3], True, False, False), name=name),
        )
        for k, name in enumerate("abcd")
    ]
    return kg.System("arm", tuple(bodies))


def test_a_coupled_freedom_leaves_x_and_y() -> None:
    system = arm().with_couplings(kg.Coupling("b", {"a": 2.0}, 0.1))
    assert system.freedom_names == ("a", "c", "link3.theta3", "link3.s1")
    assert system.coupled_names == ("b",)
    assert system.bodies[1].joint.coupled == (False, False, True, False, False, False)
    assert system.bodies[1].joint.moving[2]
    assert system.couplings[0].equation() == "link1.theta3 = 2.0 link0.theta3 + 0.1"
    assert system.coupling_equations == ("b = 2.0 a + 0.1",)
    (coupled,) = system.coupled
    assert coupled.freedom == Freedom(2, 2)
    assert coupled.terms == ((Freedom(1, 2), 2.0),)


def test_couplings_are_listed_after_those_that_they_follow() -> None:
    system = arm().with_couplings(
        kg.Coupling("a", {"b": 1.0, "c": -1.0}),
        kg.Coupling("b", {"c": 0.5}),
        kg.Coupling("link3.s1", {"a": 0.1}),
    )
    assert system.coupled_names == ("b", "a", "link3.s1")
    assert system.freedom_names == ("c", "link3.theta3")


def test_a_system_without_its_couplings_is_the_one_before() -> None:
    system = arm().with_couplings(kg.Coupling("b", {"a": 2.0}))
    assert replace(system, couplings=()) == arm()


def test_parameters_of_couplings(tmp_path: Path) -> None:
    ratio, offset = kg.Parameter("ratio", 3.0), kg.Parameter("offset", 0.2)
    system = arm().with_couplings(kg.Coupling("b", {"a": ratio}, offset))
    assert system.parameters == (ratio, offset)
    assert system.with_parameters({"ratio": 4.0}).coupled[0].terms[0][1] == kg.Parameter("ratio", 4.0)
    system.save(tmp_path / "arm.toml")
    assert kg.load(tmp_path / "arm.toml") == system


def test_a_coupling_of_a_file(tmp_path: Path) -> None:
    text = (MODELS / "double_pendulum.toml").read_text()
    file = tmp_path / "one.toml"
    file.write_text(text + '\n[[coupling]]\nfreedom = "q2"\nterms = {q1 = "l1"}\noffset = 0.5\n')
    system = kg.load(file)
    assert system.freedom_names == ("q1",)
    assert system.couplings[0].pairs[0][1] == next(p for p in system.parameters if p.name == "l1")


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ("[coupling]\nfreedom = 'q2'", r"coupling: begin each with a line \[\[coupling\]\]"),
        ("[[coupling]]\nfreedom = 'q2'", r"coupling 1: terms is missing"),
        ("[[coupling]]\nfreedom = 'q2'\nterms = 3", r"coupling 1: terms: write a table"),
        ("[[coupling]]\nfreedom = 'q2'\nterms = {}", r"would be constant. Lock it"),
        ("[[coupling]]\nfreedom = 'q2'\nterms = {q1 = 0}", r"factor of 'q1' is zero. Leave the term out"),
        ("[[coupling]]\nfreedom = 'q2'\nterms = {q1 = 'p'}", r"a string stands for a parameter"),
        ("[[coupling]]\nfreedom = 'q2'\nterms = {q3 = 1}", r"coupling of 'q2': there is no freedom 'q3'"),
        ("[[coupling]]\nfreedom = 'q2'\nterms = {q1 = 1}\nratio = 2", r"coupling 1: unknown key 'ratio'"),
    ],
)
def test_errors_in_files(tmp_path: Path, lines: str, message: str) -> None:
    file = tmp_path / "wrong.toml"
    file.write_text(f"{(MODELS / 'double_pendulum.toml').read_text()}\n{lines}\n")
    with pytest.raises(kg.ReadError, match=message):
        kg.load(file)


@pytest.mark.parametrize(
    ("couplings", "message"),
    [
        ([("a", {"a": 1.0})], r"coupling of 'a': it follows itself\. Name freedoms that move without it"),
        (
            [("a", {"d": 1.0}), ("b", {"c": 1.0}), ("c", {"b": 1.0})],
            r"there is no freedom 'd'\. .*'link3\.theta3'",
        ),
        (
            [("a", {"b": 1.0}), ("b", {"c": 1.0}), ("c", {"a": 2.0})],
            r"'link0.theta3' follows 'link1.theta3', which follows 'link2.theta3', which follows 'link0",
        ),
        ([("a", {"b": 1.0}), ("link0.theta3", {"c": 1.0})], r"coupled freedom 'link0.theta3' is used twice"),
        ([("a", {"link1.s2": 1.0})], r"'link1.s2' is locked. Free it"),
        ([("link1.s2", {"a": 1.0})], r"'link1.s2' is locked. Free it"),
        ([("a", {"b": 1.0, "link1.theta3": 2.0})], r"freedom 'link1.theta3' is used twice"),
    ],
)
def test_what_is_refused(couplings: list[tuple[str, dict[str, float]]], message: str) -> None:
    with pytest.raises(kg.ModelError, match=message):
        arm().with_couplings(*(kg.Coupling(*one) for one in couplings))


def test_a_circle_of_all_freedoms_is_named_as_one() -> None:
    names = arm().freedom_names
    pairs = zip(names, (*names[1:], names[0]), strict=True)
    with pytest.raises(kg.ModelError, match=r": a circle\. Leave one coupling out"):
        arm().with_couplings(*(kg.Coupling(one, {other: 1.0}) for one, other in pairs))


def test_prescribed_freedoms_may_be_followed_but_do_not_follow() -> None:
    system = arm().with_prescribed("a")
    assert system.with_couplings(kg.Coupling("b", {"a": 1.0})).coupled_names == ("b",)
    with pytest.raises(kg.ModelError, match=r"its motion is prescribed"):
        system.with_couplings(kg.Coupling("a", {"b": 1.0}))
    with pytest.raises(kg.ModelError, match=r"prescribed: 'b' is coupled"):
        arm().with_couplings(kg.Coupling("b", {"a": 1.0})).with_prescribed("b")


def test_a_component_of_an_angular_velocity_is_no_rate() -> None:
    joint = kg.Joint(speeds="angular_velocity")
    inertia = ((0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1))
    system = kg.System("free", (kg.Body("body", 0, 1.0, inertia, joint=joint),))
    with pytest.raises(kg.ModelError, match=r"speeds of body 'body' are its angular velocity"):
        system.with_couplings(kg.Coupling("body.s1", {"body.theta1": 0.1}))
    with pytest.raises(kg.ModelError, match=r"speeds of body 'body' are its angular velocity"):
        system.with_couplings(kg.Coupling("body.theta1", {"body.s1": 0.1}))


def test_something_must_move() -> None:
    system = kg.load(MODELS / "double_pendulum.toml").with_prescribed("q1")
    with pytest.raises(kg.ModelError, match=r"every joint is locked or prescribed or coupled"):
        system.with_couplings(kg.Coupling("q2", {"q1": 1.0}))


def test_the_effort_of_a_coupled_freedom_is_no_reaction() -> None:
    system = arm().with_couplings(kg.Coupling("b", {"a": 2.0}))
    with pytest.raises(kg.ModelError, match=r"'link1.theta3' is coupled to other freedoms"):
        system.with_reactions(["link1.theta3"])
