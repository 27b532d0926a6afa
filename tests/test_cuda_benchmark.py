"""The measurement on a card, with a driver that runs kernels on the processor; and without a card."""

import os
import subprocess
import sys

import pytest

from benchmarks.cuda import __main__, cases, nvrtc
from benchmarks.cuda.cases import Case
from tests.support.cuda import SHIM, build

SHORT = """
import sys
sys.path.insert(0, ".")
import card
if len(sys.argv) > 1:
    def refuse(name):
        raise OSError(f"{name} is not here")
    card.ctypes.CDLL = refuse
card.COUNTS, card.ROUNDS, card.LEAST_MS = (40,), 1, 0.0
sys.exit(card.main())
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """What a card needs, for few states."""
    monkeypatch.setattr(cases, "STATES", 33)
    monkeypatch.setattr(cases, "ARCHITECTURES", ("sm_90",))
    cases.write(tmp_path, (Case("panda", "float"),))
    return tmp_path


def measured(folder, *arguments, **environment):
    """Status and text of a short measurement; without a driver if there are arguments."""
    command = [sys.executable, "-c", SHORT, *arguments]
    environment = {**os.environ, **environment}
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, env=environment, check=False)
    return result.returncode, result.stdout + result.stderr


def test_a_machine_without_nvrtc_gets_one_line(monkeypatch, capsys, tmp_path):
    nvrtc.nvrtc_library.cache_clear()
    monkeypatch.setattr(nvrtc.util, "find_spec", lambda name: None)
    monkeypatch.setenv("CUDA_HOME", str(tmp_path))
    monkeypatch.setattr(sys, "argv", ["benchmarks.cuda", str(tmp_path / "cuda")])
    assert __main__.main() == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "pip install nvidia-cuda-nvrtc-cu12" in line
    assert not (tmp_path / "cuda").exists()


@pytest.mark.slow
def test_a_card_and_none(folder):
    status, text = measured(folder, "without")
    assert (status, text.startswith("no card: this machine has no driver of NVIDIA")) == (2, True)

    Case("panda", "float").source().write(folder / "cuda")
    flags = ("-shared", "-fPIC")
    build(folder, "libcuda.so.1", "cuda/panda.cu", str(SHIM / "driver.cpp"), flags=flags)
    status, text = measured(folder, LD_PRELOAD=str(folder / "libcuda.so.1"), LD_LIBRARY_PATH=str(folder))
    assert status == 0, text
    assert "the processor, compute capability 9.0" in text
    assert "panda_forward_dynamics_float: bits of the C in 33 states" in text
    assert "--fmad=false, 40 states: 4e+04 states/s (4e+04 to 4e+04), 1000.0 us a launch" in text

    with (folder / "panda_forward_dynamics_float_states.bin").open("r+b") as file:
        file.seek(-1, os.SEEK_END)
        file.write(b"\x7f")
    status, text = measured(folder, LD_PRELOAD=str(folder / "libcuda.so.1"), LD_LIBRARY_PATH=str(folder))
    assert (status, "BITS DIFFER FROM THE C" in text) == (1, True)
