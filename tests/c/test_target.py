"""A target in one file: C++ functions in a namespace, without batches; and the choice of functions."""

import re
import subprocess
from dataclasses import dataclass

import numpy as np
import pytest

import kanegen as kg
from kanegen.c.declarations import not_finite
from kanegen.c.dialect import Dialect
from kanegen.c.functions import printed_functions
from kanegen.c.target import Printed
from kanegen.errors import ModelError, OptionError
from kanegen.options import Variant
from tests.support.c_compilers import CPP, WARNINGS
from tests.support.paths import MODELS

STATES = 5
ALL_FINITE = """
inline bool all_finite(const double *numbers, std::size_t count)
{
    bool found = true;
    for (std::size_t i = 0; i < count; ++i) found = found && std::isfinite(numbers[i]);
    return found;
}
"""


class CppDialect(Dialect):
    """Statements of C++: `auto` deduces the types of locals."""

    def local(self, kind, name, text):
        return f"const auto {name} = {text};"

    def ignored(self, name):
        return f"static_cast<void>({name});"


@dataclass(frozen=True)
class Cpp:
    """A header with one inline function for each function of a model, in a namespace of its name."""

    name: str = "c++"
    longest_part: int = 100_000
    has_loops: bool = False

    def require_name(self, name):
        if name == "std":
            raise ModelError(f"system name {name!r}: the namespace is that of the C++ library.")

    def dialect(self, render_input, function):
        return CppDialect(render_input.formats, render_input.precision)

    def printed(self, render_input):
        prefix = f"{render_input.model.name}_"
        functions = []
        for function in printed_functions(render_input, self):
            head = " ".join(line.strip() for line in function.prototype).replace(f" {prefix}", " ", 1)
            functions.append("\n".join([f"inline {head}", "{", *function.code.body, "}"]))
        body = "\n\n".join(functions)
        using = "\n".join(f"using std::{name};" for name in ("sin", "cos", "sqrt"))
        model = render_input.model.name
        status = f"enum {{ {not_finite(render_input.model)} = -1000 }};"
        head = f"#pragma once\n#include <cmath>\n#include <cstddef>\n\nnamespace {model} {{\n{using}\n\n"
        text = f"{head}{status}\n{ALL_FINITE}\n{body}\n}}\n"
        return Printed({f"{model}.hpp": text}, "")


def test_a_target_is_one_class(tmp_path):
    """The C++ functions give the same bits as those of C99, with the sines and cosines of the C library."""
    system = kg.load(MODELS / "double_pendulum.toml")
    variant = Variant(sincos="libm")
    source = kg.generate(system, tier=variant, target=Cpp())
    assert list(source.files) == ["double_pendulum.hpp"]
    assert (source.target, source.artifacts) == ("c++", ())
    source.write(tmp_path)

    library = kg.build(system, tier=variant)
    rng = np.random.default_rng(1)
    n, m = len(system.freedom_names), len(system.parameters)
    states = rng.uniform(-1.0, 1.0, (STATES, 2, n))
    (tmp_path / "main.cpp").write_text(_program(system, states, m))
    command = [
        *CPP["g++"],
        "-std=c++11",
        "-O2",
        "-ffp-contract=off",
        *CPP_WARNINGS,
        "main.cpp",
        "-o",
        "main",
    ]
    subprocess.run(command, cwd=tmp_path, check=True)
    text = subprocess.run([tmp_path / "main"], capture_output=True, text=True, check=True).stdout
    found = np.array([float(number) for number in text.split()]).reshape(STATES, n * n + n)
    for row, (x, y) in zip(found, states, strict=True):
        evaluation = library.evaluate(x, y)
        expected = np.concatenate([evaluation.mass_matrix.ravel(), evaluation.forcing])
        np.testing.assert_array_equal(row, expected)


CPP_WARNINGS = [flag for flag in WARNINGS if flag not in {"-Wstrict-prototypes", "-Wmissing-prototypes"}]


def _program(system, states, m):
    """A program that prints [A] and {f} of every state."""
    n = len(system.freedom_names)
    parameters = ", ".join(repr(float(parameter.value)) for parameter in system.parameters)
    rows = ",\n".join(
        "{{" + ", ".join(map(repr, map(float, x))) + "}, {" + ", ".join(map(repr, map(float, y))) + "}}"
        for x, y in states
    )
    prepare = f"static const double p[] = {{{parameters}}}; static double c[100];" if m else ""
    first, call = ("prepare(p, c);", "c, ") if m else ("", "")
    name = system.name
    return f"""#include "{name}.hpp"
#include <cstdio>
{prepare}
static const double states[{len(states)}][2][{n}] = {{{rows}}};
int main()
{{
    {f"{name}::{first}" if first else ""}
    for (const auto &state : states) {{
        double A[{n * n}], f[{n}];
        {name}::evaluate({call}state[0], state[1], A, f);
        for (const double a : A) std::printf("%.17g ", a);
        for (const double a : f) std::printf("%.17g ", a);
    }}
}}
"""


def test_a_target_refuses_names():
    with pytest.raises(ModelError, match="is that of the C\\+\\+ library"):
        kg.generate(
            kg.System.from_arrays([0], [1.0], [np.eye(3)], np.zeros((1, 3)), np.zeros((1, 3)), name="std"),
            target=Cpp(),
        )


def test_targets_have_names():
    system = kg.load(MODELS / "planar_pendulum.toml")
    assert kg.generate(system, target="c99").files == kg.generate(system).files
    with pytest.raises(OptionError, match="unknown target 'fortran'"):
        kg.generate(system, target="fortran")


def test_functions_are_chosen():
    """Only the chosen functions are printed, with what `prepare` computes for them, and the same values."""
    system = kg.load(MODELS / "double_pendulum.toml")
    everything, one = kg.generate(system), kg.generate(system, functions=["forcing"])
    assert [function.name for function in everything.functions] == [
        "prepare",
        "mass_matrix",
        "forcing",
        "evaluate",
    ]
    assert [function.name for function in one.functions] == ["prepare", "forcing"]
    assert one.outputs == ("forcing",)
    assert one.operations == kg.generate(system, "forcing").operations | {
        "prepare": one.operations["prepare"]
    }
    assert "Outputs: forcing." in one.files["double_pendulum.h"]
    both = kg.generate(system, functions=["mass_matrix", "forcing"])
    assert both.outputs == everything.outputs
    assert both.operations["sincos"] > everything.operations["sincos"]  # two functions share nothing
    assert not re.search(r"mass_matrix\(|evaluate\(", "".join(one.files.values()))
    sizes = [next(f.outputs[0].size for f in source.functions) for source in (everything, one)]
    assert sizes == [6, 4]
    together = kg.generate(system, functions="evaluate")
    assert [function.name for function in together.functions] == ["prepare", "evaluate"]
    assert (together.outputs, together.operations) == (everything.outputs, everything.operations)


def test_a_library_has_the_chosen_functions():
    system = kg.load(MODELS / "double_pendulum.toml")
    every, one = kg.build(system), kg.build(system, functions=["forcing"])
    assert (every.forcing([0.1, 0.2], [0.3, 0.4]) == one.forcing([0.1, 0.2], [0.3, 0.4])).all()
    with pytest.raises(OptionError, match=r"without the output 'mass_matrix'\. It has forcing"):
        one.mass_matrix([0.1, 0.2])


@pytest.mark.parametrize("names", ["evaluate", ["evaluate", "forcing"], "forcing"])
def test_the_function_of_all_outputs_is_that_of_the_only_one(names):
    """`Library.evaluate` and `functions="evaluate"` follow one rule, also for a single output."""
    system = kg.load(MODELS / "planar_pendulum.toml")
    source = kg.generate(system, ["forcing"], functions=names)
    assert source.files == kg.generate(system, ["forcing"]).files
    library = kg.build(system, ["forcing"], functions=names)
    (f,) = library.evaluate([0.1, 0.2], [0.3, 0.4])
    assert (f == library.forcing([0.1, 0.2], [0.3, 0.4])).all()


@pytest.mark.parametrize(
    ("names", "message"),
    [
        (["forcin"], "unknown function 'forcin'. Did you mean 'forcing'\\?"),
        ([], "functions: name one at least. There are forcing"),
        (7, "functions: expected names, got 7"),
    ],
)
def test_functions_that_there_are_not(names, message):
    with pytest.raises(OptionError, match=message):
        kg.generate(kg.load(MODELS / "planar_pendulum.toml"), ["forcing"], functions=names)


@pytest.mark.parametrize("target", [None, 3, b"c99"])
def test_a_target_that_is_none_is_refused(target):
    with pytest.raises(OptionError, match="unknown target"):
        kg.generate(kg.load(MODELS / "planar_pendulum.toml"), target=target)
