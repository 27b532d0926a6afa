"""The page of benchmarks, made of saved times: what is slower stands first, and nothing else is claimed."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import kanegen as kg
from benchmarks import readme, summaries
from benchmarks.document import document
from kanegen.measure.machine import Machine
from kanegen.measure.timing import Times
from kanegen.studies.bench.comparison import KANEGEN, PYTHON, BenchOptions, Comparison, Entry
from kanegen.studies.bench.record import Record, read_record
from kanegen.studies.bench.results import BY_DIFFERENCES, DERIVATIVES, EQUATIONS, LOWER, Task
from kanegen.studies.bench.settings import Setting

DOCS = readme.README.parent / "docs"
MACHINE = Machine("one processor, 2 cores", "Linux x86_64", "glibc 2.36", "gcc 12", "Python 3.11")
DEFAULT = Setting("default", ("-O2", "-march=native", "-ffp-contract=off"), "AVX-512")
AVX2 = Setting("default, AVX2", ("-O2", "-march=x86-64-v3", "-ffp-contract=off"), "AVX2")
PORTABLE = Setting("portable", ("-O2", "-ffp-contract=off"), "SSE2")
CONTRACTED = Setting("contracted", ("-O3", "-march=native"), "AVX-512")
CONTRACTED_AVX2 = Setting("contracted, AVX2", ("-O3", "-march=x86-64-v3"), "AVX2")
SHIPPED = Setting("as shipped", ("-O2",), "SSE2")


def entry(
    participant: str,
    setting: Setting,
    ns: float,
    quantity: str = EQUATIONS,
    batch: bool = False,
    cores: int = 1,
    tolerance: float = 1e-10,
) -> Entry:
    """Return an entry whose rounds are within a thousandth of `ns`."""
    task = Task(f"{quantity}{' batch' * batch}", quantity, batch, tolerance=tolerance)
    times = Times(tuple(ns * (1 + 1e-3 * np.sin(k)) for k in range(9)))
    return Entry(participant, setting, task, 1e-15, times, cores)


FASTER = (
    entry("Pinocchio", CONTRACTED, 1000.0),
    entry("Pinocchio", CONTRACTED_AVX2, 1200.0),
    entry("MuJoCo", SHIPPED, 500.0),
    entry(KANEGEN, DEFAULT, 100.0),
    entry(KANEGEN, DEFAULT, 20.0, batch=True),
    entry(KANEGEN, AVX2, 120.0),
    entry(KANEGEN, PORTABLE, 250.0),
    entry(KANEGEN, DEFAULT, 80.0, LOWER),
)


def record(*entries: Entry, model: str = "panda") -> Record:
    comparison = Comparison(model, 9, entries)
    return Record("0.1.0", MACHINE, BenchOptions(256, 9, 0.05), (comparison,))


def test_what_is_behind_a_peer_stands_first() -> None:
    slower = (entry("CasADi", DEFAULT, 90.0), entry("CasADi", AVX2, 121.0), entry("CasADi", PORTABLE, 400.0))
    rows = summaries.behind(record(*FASTER, *slower).comparisons)
    assert [row[:4] for row in rows] == [
        ["panda", "A + f", "kanegen, default, AVX-512", "CasADi, default, AVX-512"]
    ]
    assert rows[0][4].startswith("1.11 (")
    page = document(record(*FASTER, *slower))
    assert page.index("| panda | A + f | kanegen, default, AVX-512 | CasADi") < page.index(
        "## One state a call"
    )
    assert "behind no peer" in document(record(*FASTER))


def test_a_case_that_is_not_certain_counts_as_behind() -> None:
    noisy = entry("CasADi", DEFAULT, 100.0)
    rounds = Times(tuple(100.0 + 30 * (-1) ** k for k in range(9)))
    near = Entry("CasADi", DEFAULT, noisy.task, 1e-15, rounds)
    rows = summaries.behind(record(*FASTER, near).comparisons)
    assert {row[3] for row in rows} == {"CasADi, default, AVX-512"}


def test_programs_are_compared_with_the_same_vector_instructions() -> None:
    (one,) = record(*FASTER).comparisons
    cases = {case.setting.name: case for case in summaries.cases(one) if case.quantity == EQUATIONS}
    found = {name: case.peer(one, "Pinocchio") for name, case in cases.items()}
    assert {name: peer and peer.median for name, peer in found.items()} == {
        "default": pytest.approx(1000, rel=1e-3),
        "default, AVX2": pytest.approx(1200, rel=1e-3),
        "portable": None,
    }
    shipped = cases["default"].peer(one, "MuJoCo")
    assert shipped is not None, "a library in compiled form is compared with all"
    lower = summaries.Case(LOWER, DEFAULT).peer(one, "Pinocchio")
    assert lower is not None
    assert lower.task.quantity == EQUATIONS


def test_peers_that_are_called_from_python_stand_beside_calls_from_python() -> None:
    jit = Setting("compiled by XLA", (), "AVX-512")
    every = (*FASTER, entry("frax", jit, 50.0), entry(PYTHON, DEFAULT, 2600.0))
    (one,) = record(*every).comparisons
    assert "frax" not in summaries.peers([one], summaries.Case(EQUATIONS, DEFAULT))
    python = summaries.Case(EQUATIONS, DEFAULT, participant=PYTHON)
    assert summaries.peers([one], python) == ["frax"]
    assert [row[3] for row in summaries.behind([one])] == ["frax, compiled by XLA, AVX-512"]


def test_differences_and_cores_are_named() -> None:
    every = (
        *FASTER,
        entry(KANEGEN, DEFAULT, 300.0, DERIVATIVES),
        entry("MuJoCo", SHIPPED, 9000.0, DERIVATIVES, tolerance=BY_DIFFERENCES),
        entry(KANEGEN, DEFAULT, 10.0, batch=True, cores=2),
        entry("Pinocchio", CONTRACTED, 500.0, cores=2),
    )
    page = document(record(*every))
    assert "| MuJoCo | differences | as shipped, SSE2 |" in page
    assert "| panda | 9 | 10.0 | 1/50.0 (" in page[page.index("## All cores") :]
    assert "A + f, batch, 2 cores, ns" in page


def test_the_page_of_a_file_is_that_of_its_record(tmp_path: Path) -> None:
    saved = record(*FASTER)
    path = tmp_path / "benchmarks.json"
    path.write_text(saved.text(), encoding="utf-8")
    assert document(read_record(path)) == document(saved)
    for name in ("one processor, 2 cores", "gcc 12", "`-O2 -march=x86-64-v3 -ffp-contract=off`"):
        assert name in document(saved)


def test_the_documents_are_made_of_the_saved_times() -> None:
    """`python -m benchmarks --render` makes them anew after a change of their text."""
    saved = read_record(DOCS / "benchmarks.json")
    assert (DOCS / "benchmarks.md").read_text(encoding="utf-8") == document(saved)
    text = readme.README.read_text(encoding="utf-8")
    assert readme.with_speed(text, saved) == text


def test_the_method_is_a_template_whose_names_are_filled_in() -> None:
    page = document(record(*FASTER))
    assert "$" not in page
    assert "This is the template" not in page
    assert "The column *compiler* names" in page


def test_the_readme_says_what_the_file_says() -> None:
    text = f"before\n{readme.BEGIN}\nold\n{readme.END}\nafter\n"
    new = readme.with_speed(text, record(*FASTER))
    assert new.startswith(f"before\n{readme.BEGIN}\n| time over Pinocchio's | A + f |")
    assert new.endswith(f"{readme.END}\nafter\n")
    assert "| panda, 9 freedoms, AVX-512 | 1/10.0 (10.0-10.0) | 1/50.0 (50.0-50.0) | - |" in new
    assert "| panda, 9 freedoms, AVX2 | 1/10.0 (10.0-10.0) | - |" in new
    assert "one processor, 2 cores, gcc 12" in new
    assert readme.with_speed(new, record(*FASTER)) == new
    with pytest.raises(kg.KanegenError, match="lacks the lines"):
        readme.with_speed("no marks", record(*FASTER))


def test_the_readme_has_the_marks() -> None:
    text = readme.README.read_text(encoding="utf-8")
    assert text.count(readme.BEGIN) == text.count(readme.END) == 1
