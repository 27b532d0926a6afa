"""The cost reports of all models in models/, written into docs/models.

python -m benchmarks.cost_reports [--docs FOLDER]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import kanegen as kg
from kanegen.files import make_folder, write_whole
from kanegen.recursion.outputs import EQUATIONS
from kanegen.studies.explain import CostReport, cost_report
from kanegen.studies.explain.tables import markdown
from kanegen.studies.markdown import markdown_table

ROOT = Path(__file__).parents[1]
MODELS = sorted((ROOT / "models").glob("*.toml"))
DOCS = ROOT / "docs" / "models"

OUTPUTS = {
    "panda_arm": ("forward_dynamics", "point_positions"),
    "satellite": ("kinetic_energy", "momentum"),
}
"""The outputs of a model in its report, where they are not [A] and {f}."""

INDEX = """\
# The models and their cost reports

Each page describes a file of [models](../../models) and compares the operations of its program with those of
the general program of its tree, in which every freedom is free, every number a run-time parameter and every
body loaded. `make cost-reports` writes these pages; a test compares them with the code."""

HEADS = ("model", "bodies", "freedoms", "outputs", "general", "operations", "ratio")


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.cost_reports", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--docs", type=Path, default=DOCS)
    folder = parser.parse_args().docs
    make_folder(folder)
    lines = []
    for model in MODELS:
        print(model.stem, flush=True)
        found = cost_report(kg.load(model), outputs(model))
        write_whole(folder / f"{model.stem}.md", page(model, found))
        lines.append(line(model, found))
    write_whole(folder / "README.md", f"{INDEX}\n\n{markdown_table(HEADS, lines)}\n")


def outputs(model: Path) -> tuple[str, ...]:
    """Return the outputs of a model in its report."""
    return OUTPUTS.get(model.stem, EQUATIONS)


def page(model: Path, found: CostReport) -> str:
    """Return the page of a model: its description, the command that makes its report, and the report."""
    options = "".join(f" --output {name}" for name in found.outputs) if found.outputs != EQUATIONS else ""
    source = f"The model is [models/{model.name}](../../models/{model.name})."
    made = f"Written by `make cost-reports`; `kanegen explain models/{model.name}{options}` prints the same."
    return markdown(found, [*description(model), f"{source} {made}"])


def line(model: Path, found: CostReport) -> list[str]:
    """Return the row of a model in the index."""
    first, last = found.steps[0], found.steps[-1]
    numbers = [str(first.total), str(last.total), f"1/{found.ratio:.1f}"]
    counts = [str(found.system.number_of_bodies), str(last.freedoms)]
    return [f"[{model.stem}]({model.stem}.md)", *counts, ", ".join(found.outputs), *numbers]


def description(model: Path) -> list[str]:
    """Return the paragraphs of the comment at the beginning of a model file."""
    comment = []
    for text in model.read_text(encoding="utf-8").splitlines():
        if not text.startswith("#"):
            break
        comment.append(text.removeprefix("#").strip())
    return "\n".join(comment).split("\n\n")


if __name__ == "__main__":
    main()
