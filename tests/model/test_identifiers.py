"""Identifiers of names in other languages: lawful, different from each other, and the same every time."""

import keyword
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kanegen.errors import OptionError
from kanegen.model.identifiers import RESERVED, identifiers

LANGUAGES = sorted(RESERVED)


def test_a_name_that_can_be_an_identifier_stays():
    assert identifiers(["elbow", "joint_2", "m1"], "rust") == ("elbow", "joint_2", "m1")


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (["elbow", "arm.theta1", "arm theta1", "for", "2nd"], None),
        (["arm theta1", "arm_theta1"], ("arm_theta1_2", "arm_theta1")),
        (["左腿", "右腿"], ("name", "name_2")),
        (["Gelenk für Ä"], ("Gelenk_fur_A",)),
        (["a__b", "a_b"], ("a_b_2", "a_b")),
        (["a", "a", "a"], ("a", "a_2", "a_3")),
        (["class", "class_", "class "], ("class_2", "class_", "class_3")),
        (["_x", "x_"], ("x", "x_")),
    ],
)
def test_other_names_become_readable_identifiers(names, expected):
    expected = expected or ("elbow", "arm_theta1", "arm_theta1_2", "for_", "name_2nd")
    assert identifiers(names, "c") == expected


@given(names=st.lists(st.text(min_size=1, max_size=80), max_size=12), language=st.sampled_from(LANGUAGES))
def test_any_names_become_different_lawful_identifiers(names, language):
    found = identifiers(names, language)
    assert len(set(found)) == len(found) == len(names)
    for one in found:
        assert re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,62}", one)
        assert "__" not in one
        assert one not in RESERVED[language]


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_reserved_word_gets_an_underscore(language):
    words = [word for word in sorted(RESERVED[language]) if "__" not in word]
    assert identifiers(words, language) == tuple(f"{word.rstrip('_')}_" for word in words)


def test_the_keywords_of_python_are_known():
    assert {*keyword.kwlist, "match", "case", "type"} <= RESERVED["python"]


def test_an_unknown_language_is_an_error():
    with pytest.raises(OptionError, match="unknown language 'rst'"):
        identifiers([], "rst")
