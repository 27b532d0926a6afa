"""The library for microcontrollers: its layout, what builds it, and what it computes."""

from __future__ import annotations

import importlib
import json
import re
import shlex
import subprocess
from collections.abc import Sequence
from pathlib import Path

import pytest

import kanegen as kg
from benchmarks.microcontrollers.boards import (
    BOARDS,
    FOLDER,
    GCC,
    Board,
    compile_for,
    compile_here,
    numbers,
    run_on,
)
from benchmarks.microcontrollers.programs import program_of_bits, program_of_costs, random_inputs
from kanegen.c import Source
from kanegen.errors import OptionError
from tests.support.c_compilers import CPP, WARNINGS, C, run
from tests.support.command import kanegen
from tests.support.pages import blocks, copy_of_checkout, files
from tests.support.paths import MODELS, PENDULUM, ROOT
from tests.support.stack_usage import calls, deepest, frames
from tests.support.systems import chain

ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
"""Arduino's own code for AVR, as Debian installs it."""


@pytest.fixture(scope="module")
def pendulum(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of the library of a double pendulum, as the command line writes it."""
    folder = tmp_path_factory.mktemp("pendulum")
    kanegen("generate", PENDULUM, "--for", "arduino", "--output", "forward_dynamics", "-o", str(folder))
    return folder / "arduino" / "double_pendulum"


def library(source: Source, folder: Path) -> Path:
    """Write the library of a source and return its folder."""
    return source.write(folder) / "arduino" / source.model.name


def test_the_layout_is_that_of_arduinos_specification(pendulum: Path) -> None:
    written = {str(path.relative_to(pendulum)) for path in pendulum.rglob("*") if path.is_file()}
    assert written == {
        *("library.properties", "keywords.txt", "library.json", "CMakeLists.txt", "idf_component.yml"),
        "README.md",
        *("zephyr/module.yml", "examples/Basic/Basic.ino"),
        *(f"src/{name}" for name in ("double_pendulum.h", "double_pendulum.c", "kanegen_sincosf.h")),
    }
    lines = (pendulum / "library.properties").read_text().splitlines()[1:]
    properties = dict(line.split("=", 1) for line in lines)
    assert {"name", "version", "author", "maintainer", "sentence", "architectures"} <= set(properties)
    assert properties["name"] == "double_pendulum"
    assert properties["includes"] == "double_pendulum.h"
    assert re.fullmatch(r"\d+\.\d+\.\d+", properties["version"])
    keywords = [line for line in (pendulum / "keywords.txt").read_text().splitlines() if line[:1] != "#"]
    assert all(re.fullmatch(r"\w+\t(KEYWORD2|LITERAL1)", line) for line in keywords)
    assert "double_pendulum_forward_dynamics\tKEYWORD2" in keywords
    assert "DOUBLE_PENDULUM_NOT_FINITE\tLITERAL1" in keywords
    (stack,) = re.findall(
        r"^\| `double_pendulum_forward_dynamics` \| (\d+) \|", (pendulum / "README.md").read_text(), re.M
    )
    assert 500 < int(stack) < 5000
    described = json.loads((pendulum / "library.json").read_text())
    assert described["headers"] == "double_pendulum.h"
    assert described["build"]["flags"] == ["-ffp-contract=off"]


def test_it_holds_the_functions_for_one_state_in_single_precision(pendulum: Path) -> None:
    system = kg.load(PENDULUM)
    alone = kg.generate(system, ["forward_dynamics"], precision="float", batches=False).files
    for path in (pendulum / "src").iterdir():
        assert path.read_text() == alone[path.name], path.name


@pytest.mark.parametrize("precision", ["double", "double-double"])
def test_another_precision_is_kept_where_it_is_asked_for(precision: str) -> None:
    source = kg.generate(kg.load(PENDULUM), precision=precision, artifacts="arduino")
    assert "const double x[2]" in source.files["arduino/double_pendulum/src/double_pendulum.h"]


@pytest.mark.parametrize("name", ["servo", "Wire", "sd"])
def test_names_of_arduinos_headers_are_refused(name: str) -> None:
    with pytest.raises(
        OptionError, match=rf"arduino: the header {name}\.h would hide one of Arduino's\. Give"
    ):
        kg.generate(kg.load(PENDULUM).with_name(name), artifacts="arduino")


def test_cmake_builds_a_static_library(pendulum: Path, tmp_path: Path) -> None:
    run("cmake", "-S", str(pendulum), "-B", str(tmp_path), folder=tmp_path)
    run("cmake", "--build", str(tmp_path), folder=tmp_path)
    assert (tmp_path / "libdouble_pendulum.a").is_file()


FRAMEWORKS = {
    "esp": """set(ESP_PLATFORM 1)
set(COMPONENT_LIB component)
function(idf_component_register)
  cmake_parse_arguments(PARSE_ARGV 0 ARG "" "" "SRCS;INCLUDE_DIRS")
  list(TRANSFORM ARG_SRCS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  list(TRANSFORM ARG_INCLUDE_DIRS PREPEND ${CMAKE_CURRENT_SOURCE_DIR}/)
  add_library(component STATIC ${ARG_SRCS})
  target_include_directories(component PUBLIC ${ARG_INCLUDE_DIRS})
endfunction()
""",
    "zephyr": """set(ZEPHYR_BASE /nowhere)
macro(zephyr_library_named name)
  add_library(component STATIC)
endmacro()
function(zephyr_library_sources file)
  target_sources(component PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/${file})
endfunction()
function(zephyr_include_directories folder)
  target_include_directories(component PUBLIC ${CMAKE_CURRENT_SOURCE_DIR}/${folder})
endfunction()
function(zephyr_library_compile_options)
  target_compile_options(component PRIVATE ${ARGV})
endfunction()
""",
}
"""Definitions that the build systems of ESP-IDF and Zephyr bring, written by their documentation."""


@pytest.mark.parametrize("framework", FRAMEWORKS)
def test_the_same_file_serves_esp_idf_and_zephyr(framework: str, pendulum: Path, tmp_path: Path) -> None:
    (tmp_path / "main.c").write_text(
        '#include "double_pendulum.h"\nint main(void) { return DOUBLE_PENDULUM_BODIES - 2; }\n'
    )
    (tmp_path / "CMakeLists.txt").write_text(
        f"cmake_minimum_required(VERSION 3.14)\nproject(user C)\n{FRAMEWORKS[framework]}"
        f"add_subdirectory({pendulum} component)\nadd_executable(user main.c)\n"
        "target_link_libraries(user component m)\nadd_test(NAME user COMMAND user)\n"
    )
    run("cmake", "-S", ".", "-B", "build", "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", folder=tmp_path)
    run("cmake", "--build", "build", folder=tmp_path)
    run("build/user", folder=tmp_path)
    commands = json.loads((tmp_path / "build" / "compile_commands.json").read_text())
    assert any("-ffp-contract=off" in one["command"] for one in commands)


SERIAL = """#include <cstdio>
#include <cstdlib>
struct {
    void begin(long) {}
    void print(const char *text) { std::printf("%s", text); }
    void print(char letter) { std::printf("%c", letter); }
    void print(unsigned long number) { std::printf("%lu", number); }
    void println(int number) { std::printf("%d\\n", number); }
    void println(double number, int digits) { std::printf("%.*f\\n", digits, number); }
} Serial;
void delay(unsigned long) { std::exit(0); }
void setup();
void loop();
int main() { setup(); for (;;) loop(); }
"""
"""Those functions of Arduino that the example calls."""


def shown(text: str) -> list[float]:
    """Return the numbers of lines such as `A[0] = 1.5`."""
    return [float(value) for value in re.findall(r"\] = (-?\d+\.?\d*(?:e[+-]?\d+)?)", text)]


@pytest.mark.parametrize("model", ["satellite", "loads", pytest.param("panda_arm", marks=pytest.mark.slow)])
def test_the_example_prints_what_the_program_in_c_prints(model: str, tmp_path: Path) -> None:
    system = chain(2, ("theta1", "s2"), loads=True) if model == "loads" else kg.load(MODELS / f"{model}.toml")
    source = kg.generate(system, ["mass_matrix", "forcing"], precision="float", artifacts="arduino")
    folder, name = library(source, tmp_path), source.model.name
    sketch = (folder / "examples" / "Basic" / "Basic.ino").read_text()
    (folder / "sketch.cpp").write_text(SERIAL + sketch)
    flags = ("-O1", "-ffp-contract=off", "-Isrc")
    run(*C["gcc"], "-std=c99", *WARNINGS, *flags, "-c", f"src/{name}.c", folder=folder)
    run(*CPP["g++"], "-Wall", "-Wextra", "-Werror", *flags, "sketch.cpp", f"{name}.o", "-lm", folder=folder)
    run(*C["gcc"], *flags, "main.c", f"{name}.c", f"{name}_batch.c", "-lm", folder=tmp_path)
    expected = shown(run("./a.out", folder=tmp_path))
    found = shown(run("./a.out", folder=folder))
    assert len(found) == len(expected) > 0
    # The example prints nine digits after the point, the other program nine significant ones.
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-9)


def test_the_program_of_the_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (command,) = blocks("embedding/microcontrollers", "console")
    monkeypatch.chdir(copy_of_checkout(tmp_path))
    kanegen(*shlex.split(command.removeprefix("$ kanegen")))
    folder = tmp_path / "build" / "board" / "arduino" / "double_pendulum"
    (folder / "main.c").write_text(files("embedding/microcontrollers")["main.c"])
    flags = ("-std=c99", *WARNINGS, "-O1", "-ffp-contract=off", "-Isrc")
    run(*C["gcc"], *flags, "main.c", "src/double_pendulum.c", "-lm", folder=folder)
    run("./a.out", folder=folder)


MOTION = ("mass_matrix", "forcing", "forward_dynamics", "step_rk4")
"""Outputs that are computed on boards."""


def source_of(model: str, outputs: Sequence[str] = MOTION, precision: str = "float") -> Source:
    """Return the code for one state of a model, or of a chain with loads on its bodies."""
    system = chain(2, ("theta1", "s2"), loads=True) if model == "loads" else kg.load(MODELS / f"{model}.toml")
    return kg.generate(system, outputs, precision=precision, batches=False)


@pytest.mark.embed("arm-none-eabi-gcc", "qemu-system-arm")
@pytest.mark.parametrize("level", ["-O0", "-O2", "-Os"])
@pytest.mark.parametrize("precision", ["float", "double"])
@pytest.mark.parametrize("model", ["double_pendulum", "panda_arm", "satellite", "loads"])
def test_boards_compute_the_bits_of_this_machine(
    model: str, precision: str, level: str, tmp_path: Path
) -> None:
    source = source_of(model, precision=precision)
    source.write(tmp_path)
    (tmp_path / "bits.c").write_text(program_of_bits(source, random_inputs(source, MOTION, 7), MOTION))
    sources = ("bits.c", f"{source.model.name}.c")
    here = run(str(compile_here(tmp_path, sources)), folder=tmp_path)
    assert here.count("forward_dynamics acceleration") == 7
    for board in BOARDS.values():
        assert run_on(board, compile_for(board, tmp_path, sources, (level,))) == here, board.name


@pytest.mark.embed("arm-none-eabi-gcc", "qemu-system-arm")
@pytest.mark.parametrize("board", BOARDS.values(), ids=BOARDS)
def test_the_self_test_passes_on_boards(board: Board, tmp_path: Path) -> None:
    """The program prints the properties of IEEE arithmetic that the compiler keeps: on boards all of them."""
    source = kg.generate(kg.load(PENDULUM), artifacts="self-test").write(tmp_path)
    properties = re.findall(r'(?:report|puts)\("([^"]+)"', (source / "selftest.c").read_text())
    program = compile_for(board, source, ["selftest.c"])
    assert run_on(board, program).splitlines() == list(dict.fromkeys(properties))


@pytest.mark.embed("arm-none-eabi-gcc", "qemu-system-arm")
@pytest.mark.parametrize("board", BOARDS.values(), ids=BOARDS)
@pytest.mark.parametrize("model", ["double_pendulum", "panda_arm", "satellite"])
def test_no_function_takes_more_stack_than_the_readme_states(
    model: str, board: Board, tmp_path: Path
) -> None:
    """The stack is measured on the board: what a call overwrites, with all that it calls."""
    source = source_of(model)
    stated = {one.name: one for one in source.footprints}
    source.write(tmp_path)
    for name in MOTION:
        (tmp_path / "cost.c").write_text(program_of_costs(source, random_inputs(source, [name], 1), name))
        one = stated[f"{model}_{name}"]
        for level in ("-O0", "-O2"):
            program = compile_for(board, tmp_path, ("cost.c", f"{model}.c"), (level,))
            found = numbers(run_on(board, program))["stack"]
            assert 0 < found <= one.stack, (name, level)
            assert level == "-O0" or found <= 1.7 * one.optimised_stack, name


@pytest.mark.embed("arm-none-eabi-gcc")
@pytest.mark.parametrize("precision", ["float", "double"])
@pytest.mark.parametrize("model", ["double_pendulum", "panda_arm", "satellite", "front_of_eight"])
def test_gcc_for_arm_keeps_to_the_memory_of_the_readme(model: str, precision: str, tmp_path: Path) -> None:
    source = source_of(model, (*MOTION, "rollout_rk4"), precision)
    source.write(tmp_path)
    file = f"{model}.c"
    for board in BOARDS.values():
        for level in ("-O0", "-O2", "-Os"):
            sizes = frames(tmp_path, file, (GCC, *board.flags, level))
            stack = deepest(calls(tmp_path, file), sizes)
            listed = run("arm-none-eabi-nm", "-S", "stack_usage.o", folder=tmp_path).splitlines()
            code = {words[3]: int(words[1], 16) for line in listed if len(words := line.split()) == 4}
            for one in source.footprints:
                assert stack[one.name] <= one.stack, (one, board.name, level)
                assert level == "-O0" or stack[one.name] <= 1.7 * one.optimised_stack, (
                    one,
                    board.name,
                    level,
                )
                assert level != "-Os" or code[one.name] <= 1.5 * one.code, (one, board.name)


@pytest.mark.embed("arm-none-eabi-gcc", "qemu-system-arm")
def test_the_kalman_filter_runs_on_a_cortex_m4f_with_the_same_bits(tmp_path: Path) -> None:
    ekf = importlib.import_module("examples.ekf_double_pendulum")
    sources = ekf.write_sources(system := kg.load(ekf.MODEL), ekf.truth(system), tmp_path)
    here = ekf.run_here(tmp_path, sources)
    board = BOARDS["Cortex-M4F"]
    program = compile_for(board, tmp_path, (*sources, FOLDER / "newlib.c"))
    assert run_on(board, program) == here
    assert len(here.splitlines()) == len(ekf.TIMES)


STEPS = (
    "step_rk4",
    "rollout_rk4",
    "step_rk4_derivatives",
    "step_implicit_midpoint",
    "step_linearly_implicit",
)


@pytest.mark.embed("cppcheck")
def test_the_code_deviates_from_exactly_the_listed_rules_of_misra(tmp_path: Path) -> None:
    page = (ROOT / "docs" / "embedding" / "misra.md").read_text()
    listed = re.findall(r"^\| ([\d.]+) \| (?:required|advisory) \|", page, re.MULTILINE)
    options = ("--addon=misra", "--enable=style", "--quiet", "--std=c99", "--template={id}")
    found: set[str] = set()
    for model in ("furuta_pendulum", "loads"):
        source = source_of(model, ("mass_matrix", "forward_dynamics", *STEPS))
        folder = source.write(tmp_path / model)
        command = ["cppcheck", *options, f"{source.model.name}.c"]
        done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=True)
        found.update(re.findall(r"^misra-c2012-([\d.]+)$", done.stderr, re.MULTILINE))
    assert sorted(found) == sorted(listed)


@pytest.mark.embed("avr-gcc", "simavr")
def test_arduino_runs_the_example(pendulum: Path, tmp_path: Path) -> None:
    """Arduino's own code for AVR, whose doubles have 32 bits, compiles the sketch; an emulator runs it."""
    core, machine = ARDUINO / "cores" / "arduino", "atmega2560"
    sketch = pendulum / "examples" / "Basic" / "Basic.ino"
    (tmp_path / "sketch.cpp").write_text("#include <Arduino.h>\n" + sketch.read_text())
    flags = [
        f"-mmcu={machine}",
        "-Os",
        "-ffunction-sections",
        "-fdata-sections",
        "-DF_CPU=16000000L",
        "-DARDUINO=10819",
    ]
    flags += [
        "-DARDUINO_ARCH_AVR",
        f"-I{core}",
        f"-I{ARDUINO / 'variants' / 'mega'}",
        f"-I{pendulum / 'src'}",
    ]
    # Debian's compiler does not accept WString.cpp, which the sketch does not need.
    cpp = [str(path) for path in core.glob("*.cpp") if path.name != "WString.cpp"]
    run("avr-gcc", *flags, "-w", "-std=gnu11", "-c", *map(str, core.glob("*.c")), folder=tmp_path)
    run(
        "avr-gcc",
        *flags,
        "-std=c99",
        *WARNINGS,
        "-c",
        str(pendulum / "src" / "double_pendulum.c"),
        folder=tmp_path,
    )
    run("avr-gcc", *flags, "-w", "-std=gnu++11", "-fno-exceptions", "-c", *cpp, "sketch.cpp", folder=tmp_path)
    objects = [path.name for path in tmp_path.glob("*.o")]
    run("avr-gcc", flags[0], "-Wl,--gc-sections", *objects, "-lm", "-o", "sketch.elf", folder=tmp_path)
    printed = _first_seconds(["simavr", "-m", machine, "-f", "16000000", "sketch.elf"], tmp_path)
    here = kg.generate(kg.load(PENDULUM), ["forward_dynamics"], precision="float").write(tmp_path / "here")
    run(
        *C["gcc"],
        "-ffp-contract=off",
        "main.c",
        "double_pendulum.c",
        "double_pendulum_batch.c",
        "-lm",
        folder=here,
    )
    expected = shown(run("./a.out", folder=here))
    # There `prepare` computes in 24 bits, and so does the function that prints decimal digits.
    assert shown(printed)[: len(expected)] == pytest.approx(expected, rel=2e-6)


@pytest.mark.embed("avr-gcc")
def test_double_precision_does_not_compile_where_a_double_has_32_bits(tmp_path: Path) -> None:
    folder = source_of("double_pendulum", ("forcing",), "double").write(tmp_path)
    command = ["avr-gcc", "-mmcu=atmega2560", "-std=c99", "-c", "double_pendulum.c"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "double has other than 53 bits here, as on AVR: generate single precision" in done.stderr


def _first_seconds(command: list[str], folder: Path) -> str:
    """Return what a program prints in its first seconds; the loop of a sketch has no end."""
    with subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT) as process:
        try:
            printed, _ = process.communicate(timeout=5.0)
        except subprocess.TimeoutExpired:
            process.kill()
            printed, _ = process.communicate()
    return printed.decode(errors="replace")
