"""Small faults, put into the code one at a time, are seen by the tests of values."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from tests.mutations.faults import Fault, faults
from tests.mutations.runner import copy, is_seen, require_sound
from tests.support.paths import ROOT

EVERY = list(faults())
FILES = sorted({fault.file for fault in EVERY})
LEAST, SHARE = 150, 0.95


def test_the_table_is_large_and_nearly_everything_is_seen() -> None:
    counted = [fault for fault in EVERY if not fault.harmless]
    assert len(counted) >= LEAST
    assert sum(not fault.unseen for fault in counted) >= SHARE * len(counted)
    assert max(Counter((fault.file, fault.text, fault.replacement) for fault in EVERY).values()) == 1
    for fault in EVERY:
        assert fault.text != fault.replacement
        assert (ROOT / fault.file).read_text(encoding="utf-8").count(fault.text) == 1, fault
        assert fault.tests and all((ROOT / test).exists() for test in fault.tests), fault.file


def test_a_fault_is_seen_and_nothing_else_is(tmp_path: Path) -> None:
    """The runner tells a fault from none, and leaves the copy as it was."""
    (tmp_path / "tests").mkdir()
    (tmp_path / "sums.py").write_text("def total(a, b):\n    return a + b\n")
    test = "from sums import total\n\n\ndef test_total():\n    assert total(2, {}) == {}\n"
    (tmp_path / "tests" / "test_sums.py").write_text(test.format(0, 2) + test.format(3, 5)[23:])
    tests = ("tests/test_sums.py",)
    require_sound(tests, tmp_path)
    assert is_seen(Fault("sums.py", "a + b", "a - b", tests), tmp_path)
    assert not is_seen(Fault("sums.py", "a + b", "b + a", tests), tmp_path)
    assert "return a + b" in (tmp_path / "sums.py").read_text()
    with pytest.raises(ValueError, match="occurs 0 times"):
        is_seen(Fault("sums.py", "a * b", "a / b", tests), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("file", FILES)
def test_faults_are_seen(file: str, tmp_path: Path) -> None:
    """Every fault makes a test fail, but for those of which the table says otherwise."""
    chosen = [fault for fault in EVERY if fault.file == file]
    folder = copy(tmp_path / "copy")
    require_sound(sorted({test for fault in chosen for test in fault.tests}), folder)
    missed = [
        f"{fault.text} -> {fault.replacement}"
        for fault in chosen
        if not fault.harmless and not fault.unseen and not is_seen(fault, folder)
    ]
    assert not missed
