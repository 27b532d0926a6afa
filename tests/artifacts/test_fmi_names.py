"""Names and units of FMI, and what depends on what."""

import itertools

import numpy as np
import pytest
from lark import Lark

import kanegen as kg
from kanegen.artifacts.fmi.layout import Layout
from kanegen.artifacts.fmi.names import dotted
from kanegen.artifacts.fmi.structure import Structure
from kanegen.artifacts.fmi.units import exponents
from kanegen.errors import OptionError
from kanegen.model.parameter_sets import least_values
from tests.support.paths import ROOT

GRAMMAR = Lark(
    r"""
    name: part ("." part)*
    part: /[A-Za-z_][A-Za-z0-9_]*/ | "'" /[A-Za-z0-9_!#$%&()*+,\-.\/:;<>=?@\[\]^{}|~ ]+/ "'"
    """,
    start="name",
)
"""The naming convention "structured" of FMI 3.0, section 2.4.7.5.1, without escapes and indices."""


@pytest.mark.parametrize(
    "name",
    ["arm", "arm.theta1", "left leg", "ä", "a.b-c", "'", '"??/', "\\n", "a\nb", "100%", "#r1#", "x" * 1000],
)
def test_every_name_becomes_a_legal_one(name):
    found = dotted("x", name)
    GRAMMAR.parse(found)
    assert found.startswith("x.")
    assert not set(found) & set('"\\?%#\n')
    assert found.isascii()


def test_names_stay_different():
    names = ["a", "a ", "a.b", "a-b", "ä", "{U+E4}", "'a'"]
    assert len({dotted(name) for name in names}) == len(names)


def test_units_have_exponents():
    assert exponents("N m") == {"kg": 1, "m": 2, "s": -2}
    assert exponents("kg m^2/s") == {"kg": 1, "m": 2, "s": -1}
    assert exponents("1/(kg m^2)") == {"kg": -1, "m": -2}
    assert exponents("rad/s^2") == {"rad": 1, "s": -2}
    assert exponents("1") == {}
    with pytest.raises(OptionError, match="'furlong' is no unit"):
        exponents("furlong")


@pytest.mark.parametrize("name", ["double_pendulum", "satellite", "gantry_crane"])
def test_dependencies_are_those_that_derivatives_find(name):
    """What the programs read includes whatever changes a result; what they do not read changes no bit."""
    system = kg.load(ROOT / "models" / f"{name}.toml")
    source = kg.generate(system, ("forward_dynamics", "coordinate_rates", "kinetic_energy", "rollout_rk4"))
    layout = Layout(source, system)
    structure = Structure(layout, source.module)
    library = kg.library.load(source, on_status="ignore")
    rng = np.random.default_rng(0)
    x, y = rng.uniform(-1, 1, len(system.coordinates)), rng.uniform(-1, 1, len(system.freedoms))
    block = layout.computed["acceleration"]
    places = {"x": layout.inputs["x"].first, "y": layout.inputs["y"].first}
    for array, element in itertools.chain(
        (("x", k) for k in range(len(x))), (("y", k) for k in range(len(y)))
    ):
        changed = {"x": x.copy(), "y": y.copy()}
        changed[array][element] += 0.37
        differs = library.forward_dynamics(**changed) != library.forward_dynamics(x, y)
        read = [bool(structure.masks[p] >> (places[array] + element) & 1) for p in block.places]
        assert not np.any(differs & ~np.array(read)), (array, element)


def test_masses_and_moments_of_inertia_have_a_smallest_value():
    assert least_values(kg.load(ROOT / "models" / "double_pendulum.toml")) == {"m1": 0.0, "m2": 0.0}
