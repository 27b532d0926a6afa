"""Machines other than x86-64: their compilers accept every file, and excess precision is refused."""

from __future__ import annotations

import pytest

import kanegen as kg
from kanegen.artifacts.selftest import selftest_text
from kanegen.library.native.build import code, write
from tests.battery import bits, targets
from tests.support import systems
from tests.support.c_compilers import WARNINGS, ZIG, run
from tests.support.cases import slow_except

MACHINES = (
    *(
        "aarch64-linux-musl",
        "riscv64-linux-musl",
        "x86-linux-musl",
        "s390x-linux-musl",
        "arm-linux-musleabihf",
    ),
    *("x86_64-linux-musl", "x86_64-windows-gnu", "aarch64-macos"),
)
"""Machines by zig's names; of these only s390x stores the most significant byte first."""

X87 = ("-target", "x86-linux-musl", "-mcpu=pentium2")
"""32-bit x86 whose numbers are computed by x87 instructions, with 64 bits or, where a mode says so, fewer."""


@pytest.fixture(params=slow_except(targets.VARIANTS, "double", "double-double"))
def folder(request, tmp_path):
    """Return the C of a chain of hinges and slides, with every header that the variant has."""
    system = systems.chain(2, ("theta1", "s2"))
    source = kg.generate(system, bits.OUTPUTS, tier=targets.VARIANTS[request.param])
    write(code(source), tmp_path)
    return tmp_path


def compiled(folder, *flags):
    """Compile every source file; an error fails the test with what the compiler says."""
    for file in sorted(folder.glob("*.c")):
        run(*ZIG, "cc", "-std=c99", *flags, "-c", file.name, "-o", "object.o", folder=folder)


@pytest.mark.parametrize("machine", slow_except(MACHINES, "aarch64-linux-musl"))
def test_every_machine_compiles_every_file_without_a_warning(machine, folder):
    compiled(folder, "-target", machine, *WARNINGS)


def test_excess_precision_is_refused(folder):
    """Results would depend on the compiler, and those of a batch would not equal those of its states."""
    with pytest.raises(AssertionError, match=r"operations have excess precision; on 32-bit x86 compile with"):
        compiled(folder, *X87)
    compiled(folder, *X87, "-msse2", "-mfpmath=sse", *WARNINGS)


def test_long_double_takes_any_machine_whose_long_double_is_wider(tmp_path):
    tier = kg.Variant(precision="long double")
    write(code(kg.generate(systems.chain(2), bits.OUTPUTS, tier=tier)), tmp_path)
    compiled(tmp_path, *X87)
    with pytest.raises(AssertionError, match=r"long double has too few bits on this platform"):
        compiled(tmp_path, "-target", "arm-linux-musleabihf")


@pytest.mark.parametrize(("flags", "says"), [(X87, False), ((*X87, "-msse2"), True)])
def test_the_self_test_tells_excess_precision(flags, says, tmp_path):
    """The word is in the program where the property holds; it is not run."""
    (tmp_path / "selftest.c").write_text(selftest_text())
    text = run(*ZIG, "cc", *flags, "-E", "selftest.c", folder=tmp_path)
    condition = next(line for line in text.splitlines() if "no excess precision" in line)
    assert ("0 == 0" in condition) is says
