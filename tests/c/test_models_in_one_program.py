"""Models whose names differ in case only: no name in C is shared, and no file takes the place of another."""

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import WriteError
from tests.support.c_compilers import CPP, WARNINGS, C, run

HINGE = kg.Joint(free=(False, False, True, False, False, False))
NAMES = ("arm", "Arm", "ARM", "aRm", "kArm", "arm_", "ARM_", "k", "K")


def model(name, mass=2.0):
    """Return an arm with a run-time mass."""
    body = kg.Body("link", 0, kg.Parameter("m", mass), np.eye(3), (0.5, 0, 0), HINGE)
    return kg.System(name, (body,))


def test_prefixes_differ_where_names_differ():
    prefixes = [kg.generate(model(name)).model.prefix for name in NAMES]
    assert len(set(prefixes)) == len(NAMES)
    assert prefixes[0] == "ARM"
    names_of_functions = {f"{name}_" for name in NAMES}
    assert not names_of_functions & {f"{prefix}_" for prefix in prefixes if prefix.lower() == prefix}


def program(names):
    """Return a program that prints [A] of several models and the place of their parameters."""
    lines = [f'#include "{name}/{name}.h"' for name in names]
    lines += ["#include <stdio.h>", "int main(void)", "{", "    const double x[1] = {0.3};"]
    for k, name in enumerate(names):
        prefix = kg.generate(model(name)).model.prefix
        lines += [
            "    {",
            f"        double p[{prefix}_PARAMETERS], c[{prefix}_PREPARED], A[{prefix}_FREEDOMS];",
            f"        p[{prefix}_P_m] = {k + 1}.0;",
            f"        {name}_prepare(p, c);",
            f"        {name}_mass_matrix(c, x, A);",
            '        printf("%.17g\\n", A[0]);',
            "    }",
        ]
    return "\n".join([*lines, "    return 0;", "}", ""])


@pytest.mark.parametrize("compiler", [*C, *CPP])
def test_models_whose_names_differ_in_case_are_in_one_program(compiler, tmp_path):
    names = ("arm", "Arm", "ARM")
    for name in names:
        kg.generate(model(name)).write(tmp_path / name)
    is_cpp = compiler in CPP
    main = "main.cpp" if is_cpp else "main.c"
    (tmp_path / main).write_text(program(names))
    command = {**C, **CPP}[compiler]
    flags = [flag for flag in WARNINGS if not (is_cpp and "prototypes" in flag)]
    for name in names:
        run(*C["gcc"], "-std=c99", "-c", f"{name}/{name}.c", "-o", f"{name}.o", folder=tmp_path)
    objects = [f"{name}.o" for name in names]
    run(*command, *flags, "-I.", main, *objects, "-lm", "-o", "program", folder=tmp_path)
    printed = run("./program", folder=tmp_path).split()
    # A thin link of mass m at 0.5 m with unit inertia: 1 + m/4.
    assert [float(number) for number in printed] == [1.25, 1.5, 1.75]


def test_file_that_differs_in_case_is_not_replaced(tmp_path):
    folder = kg.generate(model("arm")).write(tmp_path / "code")
    before = (folder / "arm.c").read_bytes()
    with pytest.raises(WriteError, match=r"holds arm.*, which is the same file as Arm.*on disks that ignore"):
        kg.generate(model("Arm")).write(folder)
    with pytest.raises(WriteError, match="on disks that ignore"):
        kg.generate(model("Arm")).write(folder, force=True)
    assert (folder / "arm.c").read_bytes() == before
    kg.generate(model("arm")).write(folder)
