"""The artifact "cpp" in g++ and clang++: the bits of C, all kinds of arrays, statuses, and no overhead."""

import functools
import re
import sysconfig
from pathlib import Path

import pytest

import kanegen as kg
from kanegen.artifacts.model_fields import model_fields
from kanegen.c.interface import PREPARE
from kanegen.program.ir import PREPARED
from tests.support import pages
from tests.support.c_compilers import CPP, SANITIZERS, C, code, run
from tests.support.paths import MODELS
from tests.support.random_trees import everything
from tests.support.strange_names import strange

WARNINGS = "-Wall -Wextra -Wpedantic -Wconversion -Wshadow -Wdouble-promotion -Werror".split()
EIGEN = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix" / "include" / "eigen3"
"""Headers of Eigen, which the package cmeel-eigen brings."""

SYSTEMS = {
    "parameters": lambda: kg.load(MODELS / "double_pendulum.toml"),
    "quaternion": lambda: kg.load(MODELS / "satellite.toml"),
    "loads": lambda: kg.load(MODELS / "cart_pole.toml"),
    "everything": lambda: everything(2, 2),
    "strange": strange,
}
OUTPUTS = {
    "parameters": ("mass_matrix", "forward_dynamics", "kinetic_energy", "step_rk4", "rollout_rk4"),
    "quaternion": ("forward_dynamics", "coordinate_rates", "body_poses"),
    "loads": ("forcing", "forward_dynamics", "step_rk4", "rollout_euler"),
    "everything": ("forcing", "contact_dynamics"),
    "strange": ("mass_matrix", "forcing", "point_positions", "operational_inertia_inverse"),
}


@functools.cache
def generated(name, precision="double"):
    outputs = OUTPUTS[name] if precision in ("double", "float") else ("forward_dynamics",)
    return kg.generate(SYSTEMS[name](), outputs, artifacts="cpp", precision=precision)


def values(kind, size, sign=1):
    """Return an initialiser; a number of double-double has two parts."""
    numbers = [f"{sign * (0.3 + 0.1 * (i % 7)):.1f}" for i in range(size)]
    if kind == "kanegen_double_double":
        return "{ {" + ", ".join(f"{{{one}, 0.0}}" for one in numbers) + "} }"
    ending = {"float": "f", "long double": "L"}.get(kind, "")
    return "{ {" + ", ".join(f"{one}{ending}" for one in numbers) + "} }"


def call(function, model, fields):
    """Return C++ that compares the three forms of a function with C, bit by bit."""
    inputs = [array for array in function.inputs if array.name != PREPARED]
    kinds = {name: field["type"] for name, field in fields["arrays"].items()}
    lines = [
        f"std::array<{kinds[a.name]}, {a.size}> {a.name} = {values(kinds[a.name], a.size)};" for a in inputs
    ]
    for a in function.outputs:
        lines.append(f"std::array<{kinds[a.name]}, {a.size}> c_{a.name}, cpp_{a.name};")
        lines.append(f"std::array<{kinds[a.name]}, {2 * a.size}> batch_{a.name};")
    prepared = ["prepared.data()"] * (len(inputs) < len(function.inputs))
    read = [a.name if a.shape else f"{a.name}[0]" for a in inputs]
    filled = [f"cpp_{a.name}" if a.shape else f"cpp_{a.name}[0]" for a in function.outputs]
    pointers = [
        *prepared,
        *(f"{a.name}.data()" for a in inputs),
        *(f"c_{a.name}.data()" for a in function.outputs),
    ]
    lines.append(f"const int status = {model}_{function.name}({', '.join(pointers)});")
    lines.append(f"check(object.{function.name}({', '.join([*read, *filled])}).value() == status);")
    lines += [f"check(same(&c_{a.name}, &cpp_{a.name}, sizeof c_{a.name}));" for a in function.outputs]
    result = function.outputs[0]
    member = "" if len(function.outputs) == 1 else f".{result.name}"
    lines.append("bool thrown = false;")
    lines.append(f"try {{ const auto result = object.{function.name}({', '.join(read)}){member};")
    lines.append(f"    check(same(&result, &c_{result.name}, sizeof result)); }}")
    lines.append("catch (const space::error &e) { thrown = true; check(e.found().value() == status); }")
    lines.append("check(thrown == (status != 0));")
    for a in inputs:
        lines.append(f"std::vector<{kinds[a.name]}> two_{a.name}({a.name}.begin(), {a.name}.end());")
        lines.append(f"two_{a.name}.insert(two_{a.name}.end(), {a.name}.begin(), {a.name}.end());")
    two = ", ".join([*(f"two_{a.name}" for a in inputs), *(f"batch_{a.name}" for a in function.outputs)])
    lines.append(f"check(object.{function.name}_batch({two}) == (status != 0 ? 2u : 0u));")
    for a in function.outputs:
        second = f"same(&batch_{a.name}[{a.size}], &c_{a.name}, sizeof c_{a.name})"
        lines.append(f"check({second} || status != 0);")
    return "{\n    " + "\n    ".join(lines) + "\n    }"


def program(source, fields):
    """Return a program that compares every function, and names and sizes with those of the system."""
    name = source.model.name
    parameters = source.model.parameters
    prepared = (
        f"std::array<{fields['arrays']['prepared']['type']}, {fields['sizes']['prepared']}> prepared;\n"
        f"    (void){name}_prepare(space::parameter_defaults.data(), prepared.data());"
        if parameters
        else ""
    )
    significant = 10 if source.precision == "long double" else 16  # bytes of a number that hold its bits
    calls = "\n    ".join(call(f, name, fields) for f in source.functions if f.name != PREPARE)
    return f"""#include <cstdio>
#include <vector>
#include "{name}.hpp"

namespace space = kanegen::{name};

static int failures = 0;
static void check(bool holds) {{ failures += holds ? 0 : 1; }}
static bool same(const void *a, const void *b, std::size_t size)
{{
    const auto *p = static_cast<const unsigned char *>(a), *q = static_cast<const unsigned char *>(b);
    for (std::size_t i = 0; i < size; i++) {{
        if (p[i] != q[i] && i % sizeof(space::number) < {significant}) {{ return false; }}
    }}
    return true;
}}

int main()
{{
    static_assert(space::number_of_freedoms == space::freedom_names.size());
    static_assert(space::number_of_coordinates == space::coordinate_names.size());
    const space::model object;
    {prepared}
    {calls}
    for (auto one : space::freedom_names) {{ std::printf("%s\\n", std::string(one).c_str()); }}
    std::printf("%d\\n", failures);
    return failures != 0;
}}
"""


def compiled(source, text, folder, compiler="g++", standard="c++17", flags=(), link=True):
    """Compile the C as C and a program as C++, and return what it prints."""
    if not (folder / f"{source.model.name}.o").exists():
        source.write(folder, force=True)
        sanitized = [flag for flag in flags if "sanitize" in flag]
        for file in code(source.model.name)[:2]:
            run(
                *C["gcc" if compiler == "g++" else "clang"],
                "-std=c99",
                "-O1",
                "-ffp-contract=off",
                *sanitized,
                "-c",
                file,
                folder=folder,
            )
    (folder / "use.cpp").write_text(text)
    objects = [file.replace(".c", ".o") for file in code(source.model.name)[:2]] if link else []
    end = [*objects, "-lm", "-o", "use"] if link else ["-fsyntax-only"]
    run(*CPP[compiler], f"-std={standard}", *WARNINGS, *flags, "use.cpp", *end, folder=folder)
    return run("./use", folder=folder) if link else ""


slow = pytest.mark.slow
CASES = [
    ("parameters", "double", "g++", "c++17"),
    ("strange", "double", "clang++", "c++20"),
    pytest.param("quaternion", "double", "g++", "c++20", marks=slow),
    pytest.param("quaternion", "double", "g++", "c++17", marks=slow),
    pytest.param("loads", "double", "clang++", "c++17", marks=slow),
    pytest.param("everything", "double", "g++", "c++17", marks=slow),
    pytest.param("parameters", "float", "clang++", "c++20", marks=slow),
    pytest.param("parameters", "long double", "g++", "c++17", marks=slow),
    pytest.param("parameters", "double-double", "g++", "c++17", marks=slow),
]


@pytest.mark.parametrize(("name", "precision", "compiler", "standard"), CASES)
def test_methods_have_the_bits_of_c(name, precision, compiler, standard, tmp_path):
    source = generated(name, precision)
    flags = SANITIZERS if (compiler, standard) == ("g++", "c++20") else ()
    printed = compiled(source, program(source, model_fields(source)), tmp_path, compiler, standard, flags)
    *names, failures = printed.splitlines()
    assert failures == "0"
    assert names == list(source.model.freedom_names)


HEAD = """#include <array>
#include <cstdio>
#include <iostream>
#include <vector>
#include "double_pendulum.hpp"
namespace pendulum = kanegen::double_pendulum;
template <class T> [[maybe_unused]] static void say(const T &value) { std::cout << value << "\\n"; }
"""

MAIN = """
int main()
{
    pendulum::model object;
    [[maybe_unused]] std::array<double, 2> x{0.3, -0.2}, y{0.1, 0.4}, tau{}, ydot{};
    %s
}
"""


def said(body, folder, head="", **how):
    """Return what a program prints whose `main` has this body."""
    return compiled(generated("parameters"), HEAD + head + MAIN % body, folder, **how).strip()


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("cpp")


def test_parameters_change_results_and_bad_ones_change_nothing(folder):
    body = """
    const double before = object.forward_dynamics(x, y, tau)[0];
    if (!object.set_parameter(pendulum::parameter::m2, 0.75).ok()) { return 1; }
    std::printf("%.17g %.17g\\n", object.parameters()[3], object.forward_dynamics(x, y, tau)[0]);
    auto bad = pendulum::parameter_defaults;
    bad[pendulum::parameter::l1] = std::numeric_limits<double>::infinity();
    say(object.set_parameters(bad).kind() == pendulum::outcome::not_finite);
    say(object.parameters()[2]);
    try { pendulum::model other(bad); } catch (const pendulum::error &e) { say(e.what()); }
    pendulum::model again(pendulum::parameter_defaults);
    say(again.forward_dynamics(x, y, tau)[0] == before);
    return 0;
    """
    lines = said(body, folder).splitlines()
    library = kg.build(SYSTEMS["parameters"]().with_parameters({"m2": 0.75}), ["forward_dynamics"])
    expected = library.forward_dynamics([0.3, -0.2], [0.1, 0.4], [0.0, 0.0])
    assert [float(one) for one in lines[0].split()] == [0.75, expected[0]]
    assert lines[1:] == ["1", "1", "double_pendulum::model: a result is infinite or NaN (status 3)", "1"]


def test_a_status_names_the_freedom(folder):
    body = """
    (void)object.set_parameters(std::array<double, 5>{9.81, 1.0, 0.0, 0.5, 0.7});
    const auto found = object.forward_dynamics(x, y, tau, ydot);
    say(found.kind() == pendulum::outcome::missing);
    say(found.place());
    try { (void)object.forward_dynamics(x, y, tau); }
    catch (const pendulum::error &e) { say(e.what()); }
    x[1] = std::numeric_limits<double>::quiet_NaN();
    say(object.mass_matrix(x, std::array<double, 4>()).kind() == pendulum::outcome::not_finite);
    return 0;
    """
    holds, place, second, third = said(body, folder).splitlines()
    assert (holds, place, third) == ("1", "q1", "1")
    text = "double_pendulum::forward_dynamics: a result does not exist in this state because of q1, "
    assert second == f"{text}or an input is infinite or NaN (status 1)"


ARRAYS = """
    double plain[2] = {0.3, -0.2};
    std::vector<double> grown{0.1, 0.4};
    const std::array<double, 2> constant{};
    double number = 0.0;
    say(object.forward_dynamics(plain, grown, constant, ydot).value());
    say(object.forward_dynamics(x, y, tau)[0] == ydot[0]);
    say(object.kinetic_energy(plain, pendulum::view<const double, 2>(grown.data()), number).value());
    say(object.kinetic_energy(x, y) == number);
    double A[2][2];
    say(object.mass_matrix(x, A).value() == 0 && A[1][1] == object.mass_matrix(x)[3]);
    std::vector<double> rows(2*100, 0.1), energies(100);
    say(object.kinetic_energy_batch(rows, rows, energies));
    say(energies[0] > 0 && energies[0] == energies[99]);
    try { (void)object.kinetic_energy_batch(rows, x, energies); }
    catch (const std::invalid_argument &e) { say(e.what()); }
    grown.push_back(1.0);
    try { (void)object.mass_matrix(grown); }
    catch (const std::invalid_argument &e) { say(e.what()); }
    try { (void)object.kinetic_energy_batch(grown, grown, energies); }
    catch (const std::invalid_argument &e) { say(e.what()); }
    std::vector<double> x_path(2*6), y_path(2*6);
    std::size_t made = 0;
    say(object.rollout_rk4(x, y, {}, 0.01, 10, 2, true, x_path, y_path, made).value());
    say(made);
    const auto after = object.step_rk4(x, y, tau, 0.01);
    (void)object.rollout_rk4(x, y, {}, 0.01, 5, 1, false, x_path, y_path, made);
    say(x_path[2] == after.x_next[0] && y_path[3] == after.y_next[1]);
    try { (void)object.rollout_rk4(x, y, {}, 0.01, 10, 1, true, x_path, y_path, made); }
    catch (const std::invalid_argument &e) { say(e.what()); }
    return 0;
"""


def test_arguments_are_arrays_of_any_kind(folder):
    printed = said(ARRAYS, folder)
    assert printed.splitlines() == [
        *("0", "1", "0", "1", "1", "0", "1"),
        "kinetic_energy_batch: arrays have different numbers of rows.",
        "kanegen: an array has 3 elements, but the function needs 2.",
        "kanegen: an array does not consist of whole rows.",
        *("0", "10", "1"),
        "rollout_rk4: x_path and y_path need steps/every + 1 rows.",
    ]


MATRICES = """
    Eigen::Vector2d xe(0.3, -0.2), ye(0.1, 0.4), te(0.0, 0.0), ae;
    Eigen::Matrix<double, 2, 2, Eigen::RowMajor> A;
    Eigen::VectorXd grown = xe;
    Eigen::Matrix<double, 4, 2, Eigen::RowMajor> many;
    many.rowwise() = xe.transpose();
    Eigen::VectorXd energies(4);
    Eigen::Map<const Eigen::Vector2d> te_mapped(tau.data());
    say(object.forward_dynamics(grown, ye, te_mapped, ae).value());
    say(object.forward_dynamics(x, y, te)[1] == ae[1]);
    say(object.mass_matrix(xe, A).value());
    say(A(0, 1) == object.mass_matrix(x)[1] && A(1, 1) == object.mass_matrix(x)[3]);
    say(object.kinetic_energy_batch(many, many, energies));
    say(object.kinetic_energy(many.row(1).transpose(), xe) == energies[1]);
    Eigen::Map<decltype(A)> mapped(A.data());
    say(object.mass_matrix(many.topLeftCorner<2, 2>().row(0), mapped).value());
    try { (void)object.kinetic_energy(many.col(0).head<2>(), xe); }
    catch (const std::invalid_argument &e) { say(e.what()); }
    Eigen::Matrix<double, 2, 3, Eigen::RowMajor> wide;
    try { (void)object.mass_matrix(xe, wide.leftCols<2>()); }
    catch (const std::invalid_argument &e) { say(e.what()); }
    grown.resize(3);
    try { (void)object.mass_matrix(grown); }
    catch (const std::invalid_argument &e) { say(e.what()); }
    return 0;
"""


@pytest.mark.slow
@pytest.mark.parametrize("standard", ["c++17", "c++20"])
def test_matrices_of_eigen_are_taken_as_they_are(folder, standard):
    flags = ("-isystem", str(EIGEN))
    printed = said(MATRICES, folder, "#include <Eigen/Core>\n", flags=flags, standard=standard)
    gaps = "kanegen: there are gaps between the numbers of a matrix. Copy it into one without gaps."
    size = "kanegen: an array has 3 elements, but the function needs 2."
    assert printed.splitlines() == ["0", "1", "0", "1", "0", "1", "0", gaps, gaps, size]


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("std::array<double, 3> z{}; (void)object.mass_matrix(z);", "the array has another size"),
        pytest.param("Eigen::Vector3d z; (void)object.mass_matrix(z);", "another size", marks=slow),
        pytest.param(
            "Eigen::Matrix2d z; (void)object.mass_matrix(x, z);", "arrays are row-major", marks=slow
        ),
        pytest.param("std::array<float, 2> z{}; (void)object.mass_matrix(z);", "no matching", marks=slow),
        pytest.param(
            "const auto z = x; (void)object.forward_dynamics(x, y, tau, z);", "no matching", marks=slow
        ),
        pytest.param("object.mass_matrix(x);", "nodiscard", marks=slow),
        pytest.param("Eigen::Vector2d z; (void)object.mass_matrix(z + z);", "no matching", marks=slow),
    ],
)
def test_what_does_not_fit_does_not_compile(folder, body, message):
    head = "#include <Eigen/Core>\n" if "Eigen" in body else ""
    with pytest.raises(AssertionError, match=message):
        said(f"{body} return 0;", folder, head, flags=("-isystem", str(EIGEN)), link=False)


@pytest.mark.slow
def test_spans_of_c20_are_arguments(folder):
    body = """
    const std::span<const double, 2> fixed(x);
    std::span<double> grown(ydot);
    say(object.forward_dynamics(fixed, y, tau, grown).value());
    return 0;
    """
    assert said(body, folder, "#include <span>\n", standard="c++20") == "0"
    assert said(body, folder, "#include <span>\n", standard="c++20", compiler="clang++") == "0"


def test_names_sizes_and_limits_are_constants(folder):
    body = """
    static_assert(pendulum::freedom_names[1] == "q2");
    static_assert(pendulum::coordinate_units[pendulum::coordinate::q1] == "rad");
    static_assert(pendulum::parameter_defaults[pendulum::parameter::l2] == 0.7);
    static_assert(pendulum::status(0).ok() && pendulum::status(-2).place() == "q2");
    static_assert(pendulum::status(-2).kind() == pendulum::outcome::inaccurate);
    return 0;
    """
    said(body, folder, flags=("-fno-exceptions",), link=False)


def test_headers_are_ascii_in_lines_of_110_columns():
    for name in ("strange", "parameters"):
        files = generated(name).files
        for text in (text for file, text in files.items() if file.endswith(".hpp")):
            assert text.isascii()
            assert name == "strange" or max(map(len, text.splitlines())) <= 110  # a name may be long
            assert not re.search(r"[ \t]$|\n\n\n", text, re.MULTILINE)


def test_two_models_are_in_one_program(tmp_path):
    generated("parameters").write(tmp_path)
    kg.generate(kg.load(MODELS / "cart_pole.toml"), artifacts="cpp").write(tmp_path, force=True)
    (tmp_path / "use.cpp").write_text(
        '#include "double_pendulum.hpp"\n#include "cart_pole.hpp"\n'
        "static_assert(kanegen::double_pendulum::number_of_parameters == 5);\n"
        "static_assert(kanegen::cart_pole::number_of_coordinates == 2);\n"
    )
    run(*CPP["g++"], "-std=c++17", *WARNINGS, "-fsyntax-only", "use.cpp", folder=tmp_path)


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
def test_a_call_costs_what_the_call_of_c_costs(tmp_path, compiler):
    """Machine code of a function that calls the method is that of one that calls the function of C."""
    source = generated("parameters")
    source.write(tmp_path)
    (tmp_path / "use.cpp").write_text("""#include "double_pendulum.hpp"
using model = kanegen::double_pendulum::model;
struct plain { double parameters[5]; double prepared[DOUBLE_PENDULUM_PREPARED]; };
extern "C" int by_c(const plain &p, const double *x, const double *y, const double *tau, double *ydot)
{
    return double_pendulum_forward_dynamics(p.prepared, x, y, tau, ydot);
}
extern "C" int by_cpp(const model &m, const std::array<double, 2> &x, const std::array<double, 2> &y,
    const std::array<double, 2> &tau, std::array<double, 2> &ydot)
{
    return m.forward_dynamics(x, y, tau, ydot).value();
}
""")
    run(
        *CPP[compiler],
        "-std=c++17",
        "-O2",
        "-fno-asynchronous-unwind-tables",
        "-S",
        "use.cpp",
        folder=tmp_path,
    )
    assembly = (tmp_path / "use.s").read_text()
    bodies = [_instructions(assembly, name) for name in ("by_c", "by_cpp")]
    assert bodies[0] == bodies[1]
    assert any("double_pendulum_forward_dynamics" in line for line in bodies[0])


def _instructions(assembly, name):
    """Return the instructions of a function, without labels and directives."""
    text = re.search(rf"^{name}:[^\n]*\n(.*?)^\s*\.size\s+{name}", assembly, re.M | re.S)[1]
    lines = (line.split("#")[0].strip() for line in text.splitlines())
    return [line for line in lines if line and not line.startswith(".") and not line.endswith(":")]


@pytest.mark.slow
def test_the_page_runs(tmp_path):
    folder = pages.copy_of_checkout(tmp_path)
    for name, text in pages.files("embedding/cpp").items():
        (folder / name).write_text(text)
    for block in pages.blocks("embedding/cpp", "console"):
        pages.run_console(block, folder)


def test_five_lines_are_enough():
    text = pages.files("embedding/cpp")["panda.cpp"]
    body = text.split("int main()")[1]
    lines = [line for line in body.splitlines() if line.strip() not in ("", "{", "}")]
    assert len([line for line in lines if "printf" not in line]) <= 5


@pytest.mark.slow
def test_states_of_a_batch_have_parameters_of_their_own(tmp_path):
    system = SYSTEMS["parameters"]()
    source = kg.generate(system, ("forward_dynamics",), artifacts="cpp", parameters_by_state=True)
    body = """
    std::vector<double> parameters(object.parameters().begin(), object.parameters().end());
    parameters.insert(parameters.end(), parameters.begin(), parameters.end());
    parameters[5 + pendulum::parameter::m2] = 0.75;
    std::vector<double> prepared(2*DOUBLE_PENDULUM_PREPARED), two{0.3, -0.2, 0.3, -0.2}, zero(4), found(4);
    say(object.prepare_batch(parameters, prepared));
    say(object.forward_dynamics_batch(prepared, two, zero, zero, found));
    say(found[0] == object.forward_dynamics(x, tau, tau)[0]);
    (void)object.set_parameter(pendulum::parameter::m2, 0.75);
    say(found[2] == object.forward_dynamics(x, tau, tau)[0]);
    return 0;
    """
    assert compiled(source, HEAD + MAIN % body, tmp_path).split() == ["0", "0", "1", "1"]


@pytest.mark.slow
def test_cmake_installs_the_headers_too(tmp_path):
    generated("parameters").write(tmp_path / "c")
    folder, prefix = tmp_path / "c", tmp_path / "installed"
    run("cmake", "-S", ".", "-B", "build", f"-DCMAKE_INSTALL_PREFIX={prefix}", folder=folder)
    run("cmake", "--build", "build", folder=folder)
    run("cmake", "--install", "build", folder=folder)
    found = {path.name for path in (prefix / "include").iterdir()}
    assert found == {"double_pendulum.h", "double_pendulum.hpp", "kanegen_views.hpp"}
    (tmp_path / "main.cpp").write_text(HEAD + MAIN % "say(object.forward_dynamics(x, y, tau)[0]); return 0;")
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.14)\nproject(user LANGUAGES CXX)\n"
        "find_package(double_pendulum REQUIRED)\nadd_executable(user main.cpp)\n"
        "target_compile_features(user PRIVATE cxx_std_17)\n"
        "target_link_libraries(user PRIVATE double_pendulum::double_pendulum)\n"
    )
    run("cmake", "-S", ".", "-B", "user", f"-DCMAKE_PREFIX_PATH={prefix}", folder=tmp_path)
    run("cmake", "--build", "user", folder=tmp_path)
    assert float(run("user/user", folder=tmp_path)) < 0
