"""The receipt of every model in models/: writes docs/models.

python -m benchmarks.receipts [--docs FOLDER]
"""

from __future__ import annotations

import argparse
from pathlib import Path

import kanegen as kg
from kanegen.files import make_folder, write_whole
from kanegen.recursion.outputs import EQUATIONS
from kanegen.studies.explain import Receipt, receipt
from kanegen.studies.explain.markdown import markdown, table

ROOT = Path(__file__).parents[1]
MODELS = sorted((ROOT / "models").glob("*.toml"))
DOCS = ROOT / "docs" / "models"

WANTED = {
    "panda_arm": ("forward_dynamics", "point_positions"),
    "satellite": ("kinetic_energy", "momentum"),
}
"""What is wanted of a model, where it is not [A] and {f}."""

INDEX = """\
# The models and their receipts

What each file in [models](../../models) describes, and what its program costs beside the general one of its
tree: every freedom free, every number a parameter, loads on every body. Written by `make receipts`; tests see
that the pages are current."""

HEADS = ("model", "bodies", "freedoms", "outputs", "general", "operations", "ratio")


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.receipts", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--docs", type=Path, default=DOCS)
    folder = parser.parse_args().docs
    make_folder(folder)
    lines = []
    for model in MODELS:
        print(model.stem, flush=True)
        found = receipt(kg.load(model), outputs(model))
        write_whole(folder / f"{model.stem}.md", page(model, found))
        lines.append(line(model, found))
    write_whole(folder / "README.md", f"{INDEX}\n\n{table(HEADS, lines)}\n")


def outputs(model: Path) -> tuple[str, ...]:
    """What is wanted of a model."""
    return WANTED.get(model.stem, EQUATIONS)


def page(model: Path, found: Receipt) -> str:
    """What its file says of a model, how to make its receipt, and the receipt."""
    options = "".join(f" --output {name}" for name in found.outputs) if found.outputs != EQUATIONS else ""
    source = f"The model is [models/{model.name}](../../models/{model.name})."
    made = f"Written by `make receipts`; `kanegen explain models/{model.name}{options}` prints the same."
    return markdown(found, [*description(model), f"{source} {made}"])


def line(model: Path, found: Receipt) -> list[str]:
    """Of the index."""
    first, last = found.steps[0], found.steps[-1]
    numbers = [str(first.total), str(last.total), f"1/{found.ratio:.1f}"]
    counts = [str(found.system.number_of_bodies), str(last.freedoms)]
    return [f"[{model.stem}]({model.stem}.md)", *counts, ", ".join(found.outputs), *numbers]


def description(model: Path) -> list[str]:
    """The paragraphs of the comment with which a model file begins."""
    comment = []
    for text in model.read_text(encoding="utf-8").splitlines():
        if not text.startswith("#"):
            break
        comment.append(text.removeprefix("#").strip())
    return "\n".join(comment).split("\n\n")


if __name__ == "__main__":
    main()
