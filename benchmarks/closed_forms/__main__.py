"""Compares closed forms with KanesMethod and textbooks; writes docs/closed-forms.md.

python -m benchmarks.closed_forms [--rounds R] [--docs FOLDER]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.closed_forms.cases import CASES
from benchmarks.closed_forms.document import document
from benchmarks.closed_forms.measuring import measured
from kanegen.files import write_whole

DOCS = Path(__file__).parents[2] / "docs"


def main() -> None:
    arguments = _arguments()
    CASES[0].closed_form()  # what SymPy loads when it is used first belongs to nobody
    CASES[0].by_kanes_method()
    results = []
    for case in CASES:
        print(case.name, file=sys.stderr, flush=True)
        results.append(measured(case, arguments.rounds))
    text = document(results, arguments.rounds)
    print(text)
    write_whole(arguments.docs / "closed-forms.md", text)
    if not all(result.agrees for result in results):
        sys.exit("some equations do not agree; the table says which")


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.closed_forms", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--docs", type=Path, default=DOCS)
    return parser.parse_args()


if __name__ == "__main__":
    main()
