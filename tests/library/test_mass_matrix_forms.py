"""[A] as its lower triangle: the bits of the whole matrix, in the places that are documented."""

from __future__ import annotations

import re
from functools import cache

import numpy as np
import pytest

import kanegen as kg
from kanegen.c.element_names import names_of_elements
from kanegen.cli.options import MATRIX_FORMS
from kanegen.errors import OptionError
from kanegen.interop.slopes import slopes
from kanegen.program.triangle import FORMS
from tests.support.c_compilers import WARNINGS, C, code, run
from tests.support.systems import random_system

TRIANGLES = FORMS[1:]
STATES = 19  # no multiple of a width of SIMD vectors
MIXED = kg.Variant(precision="double", storage="float")


@cache
def forked() -> kg.System:
    """A tree of three branches whose [A] has zeros where bodies are not related."""
    return random_system(np.random.default_rng(3), 4, connection=(0, 1, 1, 0), name="forked")


@cache
def built(form: str, tier: kg.Variant | str = "strict") -> kg.Library:
    return kg.build(forked(), ("mass_matrix",), tier=tier, mass_matrix=form)


def coordinates() -> np.ndarray:
    return np.random.default_rng(1).uniform(-1.0, 1.0, (STATES, len(forked().coordinates)))


@pytest.mark.parametrize(("form", "tier"), [*((form, "strict") for form in TRIANGLES), ("lower", MIXED)])
def test_elements_have_the_bits_of_the_whole_matrix(form, tier):
    library, x = built(form, tier), coordinates()
    whole = built("full", tier).mass_matrix(x)
    rows, columns = library.mass_matrix_places
    for found, expected in (
        (library.mass_matrix(x), whole),
        (library.mass_matrix(x[7]), whole[7]),
        (library.mass_matrix(x[:1]), whole[:1]),
    ):
        elements = found[..., rows, columns] if form == "lower" else found
        assert (elements == expected[..., rows, columns]).all()
        made = np.zeros_like(expected)
        made[..., rows, columns] = made[..., columns, rows] = elements
        assert (made == expected).all()
    assert library.source.operations == built("full", tier).source.operations


def test_places_are_those_that_are_documented():
    n = built("full").n
    assert len(built("full").mass_matrix_places[0]) == n * n
    rows, columns = built("packed").mass_matrix_places
    assert (np.arange(n * (n + 1) // 2) == rows * (rows + 1) // 2 + columns).all()
    assert (np.stack(built("lower").mass_matrix_places) == np.stack([rows, columns])).all()
    rows, columns = built("sparse").mass_matrix_places
    whole = built("full").mass_matrix(coordinates()).any(axis=0)
    assert (np.argwhere(np.tril(whole)) == np.stack([rows, columns], axis=1)).all()
    assert 0 < len(rows) < n * (n + 1) // 2


@pytest.mark.parametrize("tier", ["strict", MIXED])
def test_elements_above_the_diagonal_stay_as_they_are(tier):
    x = coordinates()
    for states in (None, STATES):
        call = built("lower", tier).bind("mass_matrix", states=states)
        call.A[...] = 7.0
        call.x = x if states else x[0]
        assert call() == 0
        assert (np.tril(call.A) + np.triu(np.full_like(call.A, 7.0), 1) == call.A).all()
        assert (np.tril(call.A) == np.tril(built("full", tier).mass_matrix(call.x))).all()


def test_a_result_that_is_not_finite_is_seen_and_what_is_not_filled_is_not_read():
    library, x = built("lower").with_on_status("ignore"), coordinates()
    call = library.bind("mass_matrix")
    call.A[...] = np.nan
    call.x = x[0]
    assert call() == 0
    call.x[0] = np.nan
    assert call() == library.n + 1
    many = library.bind("mass_matrix", states=STATES)
    many.A[...] = np.nan
    many.x = x
    assert many() == 0
    x[[2, -1]] = np.inf
    many.x = x
    assert many() == 2


def test_the_header_says_where_elements_belong():
    header = built("sparse").source.files["forked.h"].replace("\\\n", "")
    numbers = {
        name: [int(one) for one in re.search(rf"FORKED_A_{name} {{(.*?)}}", header)[1].split(",")]
        for name in ("ROW_STARTS", "COLUMNS")
    }
    rows, columns = built("sparse").mass_matrix_places
    counts = np.diff(numbers["ROW_STARTS"])
    assert (np.repeat(np.arange(len(counts)), counts) == rows).all()
    assert numbers["COLUMNS"] == columns.tolist()
    assert "A_COLUMNS" not in built("lower").source.files["forked.h"]


@pytest.mark.parametrize("target", ["c99", "cuda"])
def test_files_say_which_form_they_have(target):
    ending = {"c99": "", "cuda": "_cuda"}[target]
    n = len(forked().freedoms)
    places = {
        "full": "",
        "lower": f"element {n}*i + j",
        "packed": "element i*(i + 1)/2 + j",
        "sparse": "A_COLUMNS",
    }
    for form in FORMS:
        files = kg.generate(forked(), ("mass_matrix",), mass_matrix=form, target=target).files
        readme, header = files["README.md"].replace("\n", " "), files[f"forked{ending}.h"]
        assert ("only the lower triangle" in readme) == (form != "full")
        assert places[form] in readme
        assert (f"mass_matrix: {form}\n" in header) == (form != "full")
        assert ("#define FORKED_A_COLUMNS" in header) == (form in ("packed", "sparse"))


def test_the_example_prints_the_elements_that_are_filled(tmp_path):
    source = kg.generate(forked(), ("mass_matrix",), mass_matrix="lower")
    source.write(tmp_path)
    run(*C["gcc"], "-std=c99", *WARNINGS, "main.c", *code("forked"), "-o", "main", folder=tmp_path)
    printed = re.findall(r"A\[(\d+)\] = (\S+)", run("./main", folder=tmp_path))
    rows, columns = built("lower").mass_matrix_places
    x = [(1 + i % 7) / 10 for i in range(len(forked().coordinates))]
    expected = built("full").mass_matrix(x)[rows, columns]
    assert [int(place) for place, _ in printed] == list(built("full").n * rows + columns)
    assert [float(value) for _, value in printed] == expected.tolist()


def test_elements_have_names():
    source = built("packed").source
    (function,) = source.functions
    (names,) = names_of_elements(function.outputs[0], source.model)
    speeds = built("packed").speed_names
    assert names[:3] == (f"{speeds[0]} {speeds[0]}", f"{speeds[1]} {speeds[0]}", f"{speeds[1]} {speeds[1]}")


def test_choices_that_do_not_go_together_are_refused():
    assert MATRIX_FORMS == FORMS
    system = forked()
    with pytest.raises(OptionError, match=r"mass_matrix.*Did you mean 'lower'"):
        kg.generate(system, mass_matrix="lowr")
    with pytest.raises(OptionError, match="which is not among the outputs"):
        kg.generate(system, ("forcing",), mass_matrix="packed")
    with pytest.raises(OptionError, match="step_linearly_implicit reads the whole matrix"):
        kg.generate(system, ("step_linearly_implicit",), mass_matrix="lower")
    with pytest.raises(OptionError, match='casadi: it takes the mass matrix in the form "full"'):
        kg.generate(system, mass_matrix="packed", outputs=("mass_matrix",), artifacts=("casadi",))
    with pytest.raises(OptionError, match='simulink: it takes the mass matrix in the form "full", "packed"'):
        kg.generate(system, mass_matrix="lower", outputs=("mass_matrix",), artifacts=("simulink",))
    with pytest.raises(OptionError, match='Generate it with mass_matrix="full"'):
        slopes("mass_matrix", built("lower").source)
