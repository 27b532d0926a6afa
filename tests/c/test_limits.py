"""Limits of a model in its header: macros that initialise arrays in C and in C++."""

from __future__ import annotations

import math
from pathlib import Path

import pytest

import kanegen as kg
from tests.support import systems
from tests.support.c_compilers import CPP, WARNINGS, C, run
from tests.support.cases import slow_except

PROGRAM = """
#include <math.h>
#include <stdio.h>
#include "chain.h"

int main(void)
{
    static const REAL low[CHAIN_COORDINATES] = CHAIN_LOWER_LIMITS;
    static const REAL high[CHAIN_COORDINATES] = CHAIN_UPPER_LIMITS;
    static const REAL speed[CHAIN_FREEDOMS] = CHAIN_SPEED_LIMITS;
    static const REAL effort[CHAIN_FREEDOMS] = CHAIN_EFFORT_LIMITS;
    int i;
    for (i = 0; i < CHAIN_FREEDOMS; i++) {
        printf("%.17g %.17g ", (double)low[i], (double)high[i]);
        printf("%.17g %.17g\\n", (double)speed[i], (double)effort[i]);
    }
    return 0;
}
"""

ROWS = [
    [-0.1, 0.2, 3.0, math.inf],
    [-math.inf, math.inf, math.inf, math.inf],
    [-math.inf, 1e-3, math.inf, 1e300],
    *[[-1e-5 * k, math.pi, 1 / 3, 1e5] for k in range(1, 9)],
]
"""Limits of eleven hinges, whose macros take several lines: lower, upper, speed, effort."""


def _chain() -> kg.System:
    system = systems.chain(len(ROWS), ["theta3"])
    tables = [{"position": row[:2], "speed": row[2], "effort": row[3]} for row in ROWS]
    return system.with_limits({f"body{k}.theta3": table for k, table in enumerate(tables, start=1)})


@pytest.mark.parametrize(
    ("language", "compiler"),
    [
        *(("-std=c99", command) for command in C.values()),
        *(("-std=c++98", command) for command in CPP.values()),
    ],
)
@pytest.mark.parametrize(
    "precision", slow_except(["double", "float", "long double", "double-double"], "double")
)
def test_macros_initialise_arrays(
    language: str, compiler: tuple[str, ...], precision: str, tmp_path: Path
) -> None:
    folder = kg.generate(_chain(), ("mass_matrix",), precision=precision).write(tmp_path / "out")
    kind = "double" if precision == "double-double" else precision
    in_c = language == "-std=c99"
    warnings = [flag for flag in WARNINGS if in_c or "prototypes" not in flag]
    file = "limits.c" if in_c else "limits.cpp"
    (folder / file).write_text(f"#define REAL {kind}\n{PROGRAM}")
    run(*compiler, language, *warnings, file, "-o", "limits", folder=folder)
    lines = run("./limits", folder=folder).splitlines()
    found = [[float(word) for word in line.split()] for line in lines]
    for row, expected in zip(found, ROWS, strict=True):
        if precision == "float":
            assert row == pytest.approx(
                [x if abs(x) < 1e38 else math.copysign(math.inf, x) for x in expected], 6e-8
            )
        else:
            assert row == expected


def test_a_model_without_limits_has_no_macros() -> None:
    source = kg.generate(systems.chain(2, ["theta3"]), ("mass_matrix",))
    assert "LIMITS" not in source.files[f"{source.model.name}.h"]
