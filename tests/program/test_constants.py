"""Constants of more than double precision: exact fractions, whatever integers mpmath computes with."""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
from fractions import Fraction
from types import SimpleNamespace

import flint
import pytest

from kanegen.program.constants import MULTIPRECISION, as_fraction

GENERATE = """
import hashlib
import kanegen as kg
from tests.support import systems
import mpmath, numpy as np, sympy
tree = systems.random_system(np.random.default_rng(3), 2, orientations=True)
for tier in ("exact", kg.Variant("long double"), kg.Variant("double-double", storage="double-double")):
    files = kg.generate(tree, tier=tier).files
    print(hashlib.sha256("".join(files.values()).encode()).hexdigest())
print(mpmath.libmp.BACKEND)
"""


@pytest.mark.parametrize("integer", [int, flint.fmpz])
def test_fractions_have_integers_of_python(integer: type) -> None:
    """Integers of another library, such as gmpy2 or flint, become those of Python."""
    for text in ("-0.1", "3", "1e-30", "7e40", "0"):
        number = MULTIPRECISION.mpf(text)
        sign, mantissa, exponent, bits = number._mpf_
        found = as_fraction(SimpleNamespace(_mpf_=(sign, integer(int(mantissa)), exponent, bits)))
        assert found == Fraction(int(mantissa)) * Fraction(2) ** exponent * (-1) ** sign
        assert type(found.numerator) is type(found.denominator) is int
        assert abs(found - Fraction(text)) <= abs(Fraction(text)) / 2**319


@pytest.mark.skipif(importlib.util.find_spec("gmpy2") is None, reason="gmpy2 is not installed")
def test_gmpy2_changes_no_byte() -> None:
    """Trees with turned joints, in every precision with more digits than double."""
    plain = {"MPMATH_NOGMPY": "1", "SYMPY_GROUND_TYPES": "python"}
    printed = []
    for further in ({}, plain):
        command = [sys.executable, "-c", GENERATE]
        done = subprocess.run(command, env=os.environ | further, capture_output=True, text=True, check=True)
        printed.append(done.stdout.split())
    assert [lines.pop() for lines in printed] == ["gmpy", "python"]
    assert printed[0] == printed[1]
    assert len(set(printed[0])) == 3
