"""The boards: microcontrollers in QEMU, how programs are compiled for them and run."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

FOLDER = Path(__file__).parent
"""Folder of the C of boards."""

GCC = "arm-none-eabi-gcc"
QEMU = "qemu-system-arm"

STACK = 6144
"""Bytes that programs leave for the stack at least."""


@dataclass(frozen=True)
class Board:
    """A microcontroller in QEMU.

    Attributes:
        name: Name of its processor.
        machine: Name of the machine in QEMU.
        flags: Flags of gcc for the processor.
        flash: Bytes of memory for code and constants.
        ram: Bytes of memory for variables and stack.
        tick: Instructions in a tick of its clock; in QEMU an instruction takes a nanosecond.
    """

    name: str
    machine: str
    flags: tuple[str, ...]
    flash: int
    ram: int
    tick: float


_FPU = "-mfloat-abi=hard"

BOARDS: dict[str, Board] = {
    board.name: board
    for board in (
        Board(
            "Cortex-M0+",
            "microbit",  # a Cortex-M0, which has the same instructions
            ("-mthumb", "-mcpu=cortex-m0plus"),
            256 << 10,
            16 << 10,
            1000 / 16,
        ),
        Board(
            "Cortex-M4F",
            "mps2-an386",
            ("-mthumb", "-mcpu=cortex-m4", _FPU, "-mfpu=fpv4-sp-d16"),
            4 << 20,
            4 << 20,
            1000 / 25,
        ),
        Board(
            "Cortex-M7",
            "mps2-an500",
            ("-mthumb", "-mcpu=cortex-m7", _FPU, "-mfpu=fpv5-d16"),
            4 << 20,
            4 << 20,
            1000 / 25,
        ),
    )
}
"""Every board by the name of its processor."""

_C = ("-std=c99", "-ffp-contract=off", "-ffunction-sections", "-fdata-sections")


def compile_for(
    board: Board, folder: Path, files: Iterable[Path | str], flags: Sequence[str] = ("-O2",)
) -> Path:
    """Compile and link C for a board; functions that nothing calls are left out.

    Args:
        board: The board.
        folder: Folder of the sources, into which the program is written.
        files: Sources, relative to the folder.
        flags: Further flags of gcc.

    Raises:
        AssertionError: If gcc says anything.
    """
    program = folder / "program.elf"
    memory = {"FLASH": board.flash, "RAM": board.ram, "STACK": STACK}
    symbols = [f"-Wl,--defsym={name}={value}" for name, value in memory.items()]
    link = ["-nostartfiles", "-T", str(FOLDER / "cortex_m.ld"), "-Wl,--gc-sections", *symbols, "-lm"]
    sources = [str(FOLDER / "cortex_m.c"), *map(str, files)]
    _run([GCC, *board.flags, *_C, *flags, f"-I{FOLDER}", *sources, *link, "-o", program.name], folder)
    return program


def compile_here(folder: Path, files: Iterable[Path | str], flags: Sequence[str] = ("-O2",)) -> Path:
    """Compile the same for this machine."""
    sources = [str(FOLDER / "host.c"), *map(str, files)]
    _run(["gcc", *_C, *flags, f"-I{FOLDER}", *sources, "-lm", "-o", "program"], folder)
    return folder / "program"


def run_on(board: Board, program: Path, seconds: float = 60.0) -> str:
    """Run a program in QEMU and return what it prints.

    Raises:
        AssertionError: If its status is not 0.
        TimeoutExpired: If it does not end in time.
    """
    command = [QEMU, "-M", board.machine, "-nographic", "-icount", "shift=0"]
    command += ["-semihosting-config", "enable=on,target=native", "-kernel", str(program)]
    return _run(command, program.parent, seconds)


def flash_of(program: Path) -> int:
    """Return the bytes of code and constants of a program."""
    text, data, *_ = _run(["arm-none-eabi-size", str(program)], program.parent).splitlines()[1].split()
    return int(text) + int(data)


def _run(command: Sequence[str], folder: Path, seconds: float = 120.0) -> str:
    done = subprocess.run(
        command,
        cwd=folder,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        timeout=seconds,
        check=False,
    )
    assert done.returncode == 0 and (not done.stderr or command[0] == QEMU), (
        f"{' '.join(command)}\n{done.stdout}{done.stderr}"
    )
    return done.stdout + (done.stderr if command[0] == QEMU else "")


def numbers(text: str) -> Mapping[str, int]:
    """Return the integers that a program prints as lines `name = value`."""
    return {name: int(value) for name, _, value in (line.partition(" = ") for line in text.splitlines())}
