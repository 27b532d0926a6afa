"""Sanitizers on C that is generated anew: no byte outside an array, no undefined operation, the same bits.

Sines and cosines of many angles of one state are computed in vectors, whose last one is rarely full.
"""

from __future__ import annotations

import shutil

import pytest

import kanegen as kg
from tests.battery import bits, scenes, targets
from tests.battery.state_classes import states
from tests.support.c_compilers import SANITIZERS, WARNINGS

FLAGS = ("-O0", *SANITIZERS, "-fsanitize=float-cast-overflow")
WIDTHS = {"double": (1, 2, 4, 8), "float": (1, 4, 8, 16)}
PLAIN = ("-O0", "-DKANEGEN_LANES=1")


def require(compiler: str) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"there is no {compiler}, and zig has no address sanitizer")


def same_bits_and_no_objection(system: kg.System, variant: kg.Variant, compiler: str, width: int) -> None:
    """Compile and run in states of all classes with sanitizers and warnings, and without either."""
    source = kg.generate(system, bits.OUTPUTS, tier=variant)
    state = states(system, bits.storage(source), 3, width, targets.classes(variant))
    flags = " ".join((*FLAGS, *WARNINGS[:6], "-Werror", f"-DKANEGEN_LANES={width}"))
    found = bits.printed(source, state, compiler, flags)
    assert found == bits.printed(source, state, "gcc", " ".join(PLAIN))


@pytest.mark.parametrize(
    ("angles", "precision", "width", "compiler"),
    [
        pytest.param(7, "double", 4, "gcc", marks=pytest.mark.slow),
        (7, "float", 8, "gcc"),
        pytest.param(7, "float", 8, "clang", marks=pytest.mark.slow),
        (3, "double", 8, "gcc"),
        pytest.param(7, "double", 4, "clang", marks=pytest.mark.slow),
    ],
)
def test_angles_in_vectors(angles: int, precision: str, width: int, compiler: str) -> None:
    """Seven angles are two vectors of four that share an angle, or one of eight that is not full."""
    require(compiler)
    system = scenes.straight(angles)
    source = kg.generate(system, bits.OUTPUTS, tier=kg.Variant(precision=precision))
    assert f"simd_vector_sincos({angles}, x, sines, cosines)" in source.files["planar.c"]
    same_bits_and_no_objection(system, kg.Variant(precision=precision), compiler, width)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("angles", [2, 3, 5, 6, 8, 9, 11, 13, 16, 17])
@pytest.mark.parametrize("precision", WIDTHS)
def test_every_number_of_angles_in_every_width(precision: str, angles: int, compiler: str) -> None:
    require(compiler)
    for width in WIDTHS[precision]:
        variant = kg.Variant(precision=precision)
        same_bits_and_no_objection(scenes.straight(angles), variant, compiler, width)


@pytest.mark.slow
@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize("name", targets.VARIANTS)
def test_every_kind_of_joint_in_every_variant(name: str, compiler: str) -> None:
    require(compiler)
    same_bits_and_no_objection(targets.system(), targets.VARIANTS[name], compiler, 4)
