"""acados, whose generated C calls the functions of CasADi that kanegen prints."""

import os
import subprocess
import sys

import numpy as np
import pytest

import kanegen as kg
from tests.support import pages
from tests.support.acados import environment
from tests.support.casadi_functions import by_reference
from tests.support.paths import MODELS, ROOT


@pytest.mark.embed
def test_the_swing_up_of_the_page_converges_and_keeps_the_equations(tmp_path):
    (tmp_path / "acados").mkdir()
    variables = environment(tmp_path / "acados")
    folder = pages.copy_of_checkout(tmp_path)
    for name, separator, place in (
        ("PYTHONPATH", os.pathsep, ROOT),
        ("LD_LIBRARY_PATH", ":", folder / "build"),
    ):
        variables[name] += f"{separator}{place}"
    script = pages.files("embedding/casadi")["acados_cart_pole.py"]
    (folder / "acados_cart_pole.py").write_text(script)
    done = subprocess.run(
        [sys.executable, "acados_cart_pole.py"],
        cwd=folder,
        env=variables,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = np.load(folder / "build" / "swing_up.npz")
    states, forces = found["states"], found["forces"].ravel()
    assert np.abs(forces).max() == pytest.approx(20.0)
    system = kg.load(MODELS / "cart_pole.toml")
    for before, after, force in zip(states, states[1:], forces, strict=False):
        np.testing.assert_allclose(by_reference(system, before, force, 0.05), after, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(states[0], [np.pi, 0, 0, 0], atol=1e-12)
    np.testing.assert_allclose(states[-1], 0.0, atol=0.3)
