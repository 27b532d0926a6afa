"""docs/simulate.md: its Python runs and gives the values that its comments show, and its commands exist."""

from __future__ import annotations

import re
import shlex

import numpy as np
import pytest

import kanegen as kg
from tests.support.command import kanegen
from tests.support.paths import ROOT

PAGE = (ROOT / "docs" / "simulate.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


def test_the_python_of_the_page(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    space: dict[str, object] = {}
    for block in BLOCKS:
        exec(block, space)
        for shown, value in re.findall(
            r"^(?:print\()?([\w.\[\]\"=() -]+?)\)? {2,}# (.*)$", block, flags=re.MULTILINE
        ):
            if "=" not in shown.replace("==", "") and not value.startswith(("until", "(T")):
                assert str(eval(shown, space)) == value, shown
    printed = capsys.readouterr().out
    assert "rounding allows 1e-06 until about" in printed
    motion = space["wild"]
    assert isinstance(motion, kg.simulate(space["system"], None, None, [0.0, 0.1], step=0.1).__class__)
    assert np.isfinite(motion.x).all()


@pytest.mark.slow
def test_the_commands_of_the_page(
    monkeypatch: pytest.MonkeyPatch, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("page")
    commands = [line[2:] for line in PAGE.splitlines() if line.startswith("$ kanegen ")]
    assert len(commands) == 4
    for command in commands:
        words = shlex.split(command)[1:]
        words[1] = str(ROOT / words[1])
        monkeypatch.chdir(folder)
        done = kanegen(*words)
    assert (folder / "motion.csv").exists() and (folder / "motion.svg").exists()
    told = PAGE.partition("--error 1e-6\n")[2].partition("--error 1e-6\n")[2].splitlines()[:3]
    assert done.stdout.splitlines()[2] == told[2]
    assert done.stdout.splitlines()[0].startswith(told[0][:50])
