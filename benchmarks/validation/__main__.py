"""Compares kanegen with cases that others have published; writes docs/validation.md.

python -m benchmarks.validation [--only NAME ...] [--docs FOLDER]
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from benchmarks.validation.cases import CASES
from benchmarks.validation.document import document
from kanegen.files import write_whole

DOCS = Path(__file__).parents[2] / "docs"


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.validation", description=__doc__.splitlines()[0]
    )
    parser.add_argument("--only", nargs="+", choices=CASES, help="compute these cases and write no document")
    parser.add_argument("--docs", type=Path, default=DOCS)
    arguments = parser.parse_args()
    cases = []
    for name in arguments.only or CASES:
        cases.append(CASES[name].full())
        verdict = "holds" if cases[-1].holds else "FAILS"
        print(f"{cases[-1].title}: {verdict}, {cases[-1].share:.2g} of what is allowed", flush=True)
    if not arguments.only:
        write_whole(arguments.docs / "validation.md", document(cases))
    failing = [case.title for case in cases if not case.holds]
    if failing:
        sys.exit(f"differences are larger than the sources allow: {', '.join(failing)}")


if __name__ == "__main__":
    main()
