"""Contacts in models and model files, and what is refused of them."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import kanegen as kg

TOML = """
name = "leg"
frames = {floor = {position = [0, 0, -1]}}
[parameters]
mu = 1e-6
[[body]]
name = "thigh"
connection = "ground"
mass = 3.0
joint = {name = "hip", free = ["theta2", "s1", "s3"]}
[[body]]
name = "shank"
connection = "thigh"
mass = 1.0
mass_center = [0, 0, -0.2]
inertia = [0.1, 0.1, 0.1]
joint = {name = "knee", free = ["theta2"], position = [0, 0, -0.4]}
frames.sole = {position = [0, 0, -0.4], orientation_angles = [0, 0.3, 0]}
points.toe = {position = [0.1, 0, 0], frame = "sole"}
[[contact]]
name = "stance"
frame = "sole"
directions = ["force3", "moment2", "force1"]
damping = "mu"
[[contact]]
point = "toe"
"""


@pytest.fixture
def leg(tmp_path: Path) -> kg.System:
    file = tmp_path / "leg.toml"
    file.write_text(TOML)
    return kg.load(file)


def test_a_file_with_contacts(leg: kg.System) -> None:
    stance, toe = leg.contacts
    assert stance.directions == ("moment2", "force1", "force3")
    assert stance.damping == kg.Parameter("mu", 1e-6)
    assert toe == kg.Contact("toe", point="toe")
    assert leg.contact_names == (
        "stance.moment2",
        "stance.force1",
        "stance.force3",
        "toe.force1",
        "toe.force2",
        "toe.force3",
    )
    assert [row.effort for row in leg.contact_rows] == ["N m", *["N"] * 5]
    assert [parameter.name for parameter in leg.parameters] == ["mu"]


def test_they_are_saved_and_read(leg: kg.System, tmp_path: Path) -> None:
    leg.save(tmp_path / "again.toml")
    assert kg.load(tmp_path / "again.toml") == leg


def test_names_stand_for_contacts_points_frames_and_bodies(leg: kg.System) -> None:
    assert leg.with_contacts("stance").contacts == leg.contacts[:1]
    chosen = leg.with_contacts(["toe", "sole", 1, kg.Contact("heel", point="sole", damping=1)])
    assert chosen.contacts == (
        kg.Contact("toe", point="toe"),
        kg.Contact("sole", frame="sole"),
        kg.Contact("thigh", frame="thigh"),
        kg.Contact("heel", point="sole", damping=1.0),
    )
    assert len(chosen.contact_rows) == 3 + 6 + 6 + 3
    assert leg.with_contacts(()).contacts == ()
    assert leg.with_contacts(["toe:force3+force1", "stance:force3"]).contacts == (
        kg.Contact("toe", point="toe", directions=("force1", "force3")),
        kg.Contact("stance", frame="sole", directions=("force3",), damping=kg.Parameter("mu", 1e-6)),
    )


def test_they_stay_where_freedoms_are_locked_and_parameters_change(leg: kg.System) -> None:
    assert leg.with_locked({"knee": 0.1}).contacts == leg.contacts
    assert leg.with_parameters({"mu": 0.5}).contacts[0].damping == kg.Parameter("mu", 0.5)


def test_a_summary_says_what_is_held(leg: kg.System) -> None:
    assert [contact.summary for contact in leg.contacts] == [
        "stance: holds frame sole by moment2, force1, force3, damping mu",
        "toe: holds point toe",
    ]


@pytest.mark.parametrize(
    ("before", "after", "message"),
    [
        (
            'frame = "sole"\nd',
            'frame = "sol"\nd',
            "contact 'stance': there is no frame or body 'sol'. Did you mean 'sole'",
        ),
        (
            'frame = "sole"\nd',
            'frame = "toe"\nd',
            "contact 'stance': .* a point of this name; write point = 'toe'",
        ),
        ('frame = "sole"\nd', 'frame = "floor"\nd', "contact 'stance': 'floor' is fixed to the ground"),
        ('frame = "sole"\nd', 'frame = "ground"\nd', "contact 'stance': 'ground' is fixed to the ground"),
        ('point = "toe"', 'point = "to"', "contact 'to': there is no point or frame 'to'"),
        ('point = "toe"', 'name = "stance"\npoint = "toe"', "contact name 'stance' is used twice"),
        ('point = "toe"', "frame = 3", "contact '': frame: 3 is not a string"),
        ('point = "toe"', "", "contact '': neither a point nor a frame is held"),
        ('point = "toe"', 'point = "toe"\nframe = "sole"', "contact '': both a point and a frame are held"),
        ('"moment2"', '"moment4"', "contact 'stance': there is no direction 'moment4'"),
        ('"moment2"', '"force3"', "contact 'stance': direction 'force3' is named twice"),
        ('["force3", "moment2", "force1"]', "[]", "contact 'stance': it holds in no direction"),
        (
            '["force3", "moment2", "force1"]',
            "{force1 = false}",
            r"contact 'stance': directions are a table. Write a list of those that hold, as in \['force1'\]",
        ),
        (
            'point = "toe"',
            'point = "toe"\ndirections = ["moment1"]',
            "contact 'toe': .* Moments hold frames alone",
        ),
        ('damping = "mu"', "damping = -1", "contact 'stance': its damping -1.0 is negative"),
        ('damping = "mu"', 'damping = "nu"', "contact 1: damping: .* there is no 'nu'"),
        ('damping = "mu"', "dampng = 1", "contact 1: unknown key 'dampng'. Did you mean 'damping'"),
    ],
)
def test_what_cannot_be_held_is_refused(before: str, after: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "leg.toml"
    assert before in TOML
    file.write_text(TOML.replace(before, after))
    with pytest.raises(kg.ReadError, match=message) as caught:
        kg.load(file)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (
            lambda leg: leg.with_contacts("hip"),
            "contacts: there is no contact, point, frame or body 'hip'. Known are 'thigh'",
        ),
        (lambda leg: leg.with_contacts("stanc"), "or body 'stanc'. Did you mean 'stance'"),
        (lambda leg: leg.with_contacts("floor"), "contact 'floor': 'floor' is fixed to the ground"),
        (lambda leg: leg.with_contacts(["toe", "toe"]), "contact name 'toe' is used twice"),
        (lambda leg: leg.with_contacts(3), "contacts: there is no contact, point, frame or body 3"),
        (lambda leg: leg.with_contacts([True]), "point, frame or body True"),
        (lambda leg: leg.with_contacts(None), "point, frame or body None"),
        (lambda leg: leg.with_contacts("toe:force4"), "contact 'toe': there is no direction 'force4'"),
        (lambda leg: leg.with_contacts("toes:force1"), "point, frame or body 'toes:force1'"),
        (lambda leg: kg.Contact("a", point="toe", directions="force4"), "no direction 'force4'"),
    ],
)
def test_a_choice_that_means_nothing_is_refused(
    leg: kg.System, ask: Callable[[kg.System], object], message: str
) -> None:
    with pytest.raises(kg.ModelError, match=message):
        ask(leg)
