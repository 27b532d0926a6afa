"""docs/linearize.md: its Python runs and gives the values that its comments show."""

from __future__ import annotations

import re

import pytest

from tests.support.paths import ROOT

PAGE = (ROOT / "docs" / "linearize.md").read_text(encoding="utf-8")


def test_the_python_of_the_page(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.chdir(ROOT)
    code = "\n".join(re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL))
    space: dict[str, object] = {}
    exec(code, space)
    printed = capsys.readouterr().out
    for line in re.findall(r"prints, with.*?```\n(.*?)```", PAGE, flags=re.DOTALL)[0].splitlines():
        assert line in printed
    assert "momentum of cart_position = " in printed
    comments = re.findall(r"^(model\.\S+|linear\.A\[2, 0\]) +# (.*)$", code, flags=re.MULTILINE)
    shown = {expression: str(eval(expression, space)) for expression, _ in comments}
    told = dict(comments)
    for expression in ("model.state_names", "linear.A[2, 0]"):
        assert shown[expression] == told[expression]
    assert shown["model.modes[0].growth"].startswith("3.97")
    assert f"'{shown['model.stability.verdict']}'" == told["model.stability.verdict"]
