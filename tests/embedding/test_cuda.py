"""Kernels in JAX: through its foreign function interface, on the processor in place of a GPU.

The handlers and kernels are those for a GPU, compiled by a shim of nvcc and registered for the processor.
"""

from __future__ import annotations

import importlib
import os
import pickle
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import BuildError, OptionError
from tests.support.cuda import SHIM
from tests.support.pages import blocks
from tests.support.paths import MODELS, ROOT

pytestmark = [pytest.mark.embed("jax"), pytest.mark.filterwarnings("ignore:os.fork:RuntimeWarning")]

NVCC = f"sh {SHIM / 'nvcc'}"


@pytest.fixture(scope="module", autouse=True)
def jax() -> Iterator[Any]:
    """JAX with numbers of 64 bits, whose calls of kernels go to the processor."""
    jax = importlib.import_module("jax")
    cuda = importlib.import_module("kanegen.interop.jax.cuda")
    before = jax.config.jax_enable_x64
    jax.config.update("jax_enable_x64", True)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cuda, "PLATFORM", "cpu")
        yield jax
    jax.config.update("jax_enable_x64", before)


def functions(model: Any, *outputs: str, **choices: Any) -> Any:
    return importlib.import_module("kanegen.interop.jax").functions(model, outputs, **choices)


@pytest.fixture(scope="module")
def pendulum() -> kg.System:
    return kg.load(MODELS / "double_pendulum.toml")


@pytest.fixture(scope="module")
def kernels(pendulum: kg.System, jax: Any) -> Any:
    return functions(pendulum, "forward_dynamics", device="cuda", nvcc=NVCC)


@pytest.fixture(scope="module")
def on_cpu(pendulum: kg.System, jax: Any) -> Any:
    return functions(pendulum, "forward_dynamics", flags="-O1 -ffp-contract=off", on_status="ignore")


def test_values_and_batches(kernels: Any, on_cpu: Any, jax: Any) -> None:
    """Bits of the CPU, for one state, for many, by `vmap` and compiled, with parameters of each state."""
    x, y, tau = np.random.default_rng(1).normal(size=(3, 4, 5, 2))
    expected = np.asarray(on_cpu.forward_dynamics(x, y, tau))
    assert (np.asarray(kernels.forward_dynamics(x, y, tau)) == expected).all()
    assert (np.asarray(jax.jit(jax.vmap(kernels.forward_dynamics))(x, y, tau)) == expected).all()
    assert (np.asarray(kernels.forward_dynamics(x[0, 0], y[0, 0], tau[0, 0])) == expected[0, 0]).all()
    parameters = {"m2": np.array([0.4, 0.5, 0.6, 0.7, 0.8])}
    found = kernels.forward_dynamics(x, y, tau, parameters=parameters)
    assert (np.asarray(found) == np.asarray(on_cpu.forward_dynamics(x, y, tau, parameters=parameters))).all()


def test_gradients(kernels: Any, on_cpu: Any, jax: Any) -> None:
    x, y, tau = np.random.default_rng(2).normal(size=(3, 2))
    for mode in (jax.jacfwd, jax.jacrev):
        of = [mode(one.forward_dynamics, argnums=(0, 1, 2))(x, y, tau) for one in (kernels, on_cpu)]
        for found, expected in zip(*of, strict=True):
            assert (np.asarray(found) == np.asarray(expected)).all()


def test_states_without_results_are_nan(kernels: Any) -> None:
    x = np.array([[0.1, 0.2], [np.nan, 0.0]])
    found = np.asarray(kernels.forward_dynamics(x, 0 * x, 0 * x))
    assert np.isfinite(found[0]).all()
    assert np.isnan(found[1]).any()


def test_kernels_in_single_precision_of_a_library(jax: Any) -> None:
    library = kg.build(kg.load(MODELS / "panda_arm.toml"), ["forward_dynamics"], precision="float")
    panda = functions(library, device="cuda", nvcc=NVCC)
    x, y, tau = np.random.default_rng(3).normal(size=(3, 40, 7)).astype(np.float32)
    assert (np.asarray(panda.forward_dynamics(x, y, tau)) == library.forward_dynamics(x, y, tau)).all()
    again = pickle.loads(pickle.dumps(panda))
    assert (np.asarray(again.forward_dynamics(x, y, tau)) == library.forward_dynamics(x, y, tau)).all()


def test_what_is_refused(pendulum: kg.System) -> None:
    with pytest.raises(OptionError, match="unknown device 'gpu'"):
        functions(pendulum, "forward_dynamics", device="gpu")
    with pytest.raises(OptionError, match="a GPU does not wait for statuses"):
        functions(pendulum, "forward_dynamics", device="cuda", on_status="raise")
    with pytest.raises(BuildError, match="there is no compiler 'nvcc-that-is-missing'"):
        functions(pendulum, "forward_dynamics", device="cuda", nvcc="nvcc-that-is-missing")
    with pytest.raises(OptionError, match="target cuda: it has no step_rk4"):
        functions(pendulum, "step_rk4", device="cuda", nvcc=NVCC)


def test_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    """The lines of the page for JAX; its programs in CUDA C++ are run by tests/c/test_cuda.py."""
    monkeypatch.setenv("PATH", f"{SHIM}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.chdir(ROOT)
    names: dict[str, Any] = dict(zip(("x", "y", "tau"), np.full((3, 7), 0.1, np.float32), strict=True))
    exec("".join(blocks("embedding/cuda", "python")), names)
    expected = names["panda"].library.forward_dynamics(names["x"], names["y"], names["tau"])
    assert (np.asarray(names["ydot"]) == expected).all()
