"""Arguments of wrong types and sizes: public functions raise one error, in one line of bounded length."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import LONGEST_MESSAGE, QUOTED, counted, quoted
from tests.support.paths import MODELS


class Unprintable:
    """An object whose `repr` fails."""

    def __repr__(self) -> str:
        raise RuntimeError("no text")


PAYLOAD = kg.Parameter("payload", 2.0)
HINGE = kg.Joint(position=(0, 0, 0.4), free=(False, False, True, False, False, False))
ARM = kg.Body("arm", 0, PAYLOAD, ((1, 0, 0), (0, 1, 0), (0, 0, 1)), (0.1, 0, 0.2), HINGE)
SYSTEM = kg.System("one", (ARM,)).with_points({"tip": ("arm", (0, 0, 1))})

WRONG: tuple[Any, ...] = (
    *(None, 3, 2.5, True, "x", "", "a" * 10**6, "\x00", "a\nb", b"x", 1j, int, object(), Unprintable()),
    *([], [1], [[1]], {}, {"a": 1}, {1: 2}, set(), (1, 2), ("a",), range(3), SYSTEM, PAYLOAD, lambda: 1),
    *(np.zeros(3), np.zeros((2, 2)), np.array(3), np.array(["a"]), np.array([None])),
    *(10**5000, -(10**5000), float("nan"), float("inf"), -1, 0),
)

GOOD: dict[str, Any] = {
    "name": "a",
    "lower": 0,
    "mass": 1.0,
    "inertia": np.eye(3),
    "connection": [0],
    "mass_center": [[0, 0, 0.5]],
    "joint_position": [[0, 0, 0]],
    "value": 1.0,
    "freedom": "arm.theta3",
    "effort": "1",
    "between": ("a", "b"),
    "point": "tip",
    "energy": "1",
    "position": (0, 0, 0),
    "text": "1",
    "bodies": (ARM,),
    "system": SYSTEM,
    "terms": {"arm.theta3": 1.0},
    "x": [0.1],
    "y": [0.1],
    "path": MODELS / "cart_pole.toml",
}
"""Values for the arguments beside the wrong one."""

CLASSES = (
    kg.System,
    kg.Body,
    kg.Joint,
    kg.Coupling,
    kg.Point,
    kg.Parameter,
    kg.JointSpring,
    kg.Spring,
    kg.Drive,
)
FUNCTIONS: dict[str, Callable[..., Any]] = {
    **{kind.__name__: kind for kind in (*CLASSES, kg.PointLoad, kg.Potential)},
    **{f"System.{name}": getattr(SYSTEM, name) for name in dir(SYSTEM) if name.startswith("with_")},
    "System.from_arrays": kg.System.from_arrays,
    "Joint.with_right_angles": HINGE.with_right_angles,
    "Joint.with_prescribed": HINGE.with_prescribed,
    "parse": kg.parse,
    "load": kg.load,
    "reanchored": kg.reanchored,
}


def cases() -> Iterator[tuple[str, str]]:
    """Yield every function with each of its arguments."""
    for name, function in FUNCTIONS.items():
        for argument in inspect.signature(function).parameters:
            if (name, argument) != ("Joint.with_prescribed", "index"):  # counts FREEDOMS, inside the package
                yield name, argument


@pytest.mark.filterwarnings("ignore::kanegen.KanegenWarning")
@pytest.mark.parametrize(("name", "argument"), [*cases()])
def test_wrong_argument_is_one_bounded_line(name: str, argument: str) -> None:
    function = FUNCTIONS[name]
    signature = inspect.signature(function).parameters
    needed = {
        other.name: GOOD[other.name]
        for other in signature.values()
        if other.default is other.empty and other.kind is not other.VAR_POSITIONAL and other.name != argument
    }
    if name == "Body":
        needed["mass"], needed["inertia"] = 1.0, np.eye(3)
    for value in WRONG:
        try:
            if signature[argument].kind is inspect.Parameter.VAR_POSITIONAL:
                function(value)
            else:
                function(**{argument: value, **{k: v for k, v in needed.items() if k != argument}})
        except kg.KanegenError as error:
            assert len(str(error)) <= LONGEST_MESSAGE
            assert str(error).isprintable(), repr(str(error))


@pytest.mark.parametrize(
    ("function", "argument"),
    [
        *((kg.derive, argument) for argument in ("speeds", "coordinates")),
        *((kg.generate, name) for name in ("outputs", "without", "functions", "artifacts", "reanchoring")),
        *((kg.build, argument) for argument in ("compiler", "flags", "threads", "outputs")),
        *((kg.compare, argument) for argument in ("states", "seed")),
    ],
)
def test_wrong_option_is_one_bounded_line(function: Callable[..., Any], argument: str) -> None:
    """Values of types that no option has; strings and small numbers are options of some."""
    wrong = (
        1j,
        object(),
        Unprintable(),
        np.zeros((2, 2)),
        np.array(3),
        np.array([None]),
        10**5000,
        [[1]],
        {1: 2},
    )
    for value in wrong:
        try:
            function(SYSTEM, **{argument: value})
        except kg.KanegenError as error:
            assert len(str(error)) <= LONGEST_MESSAGE
            assert str(error).isprintable(), repr(str(error))


@pytest.mark.parametrize("value", WRONG, ids=[type(value).__name__ for value in WRONG])
def test_library_refuses_tables_of_other_types(value: Any) -> None:
    library = kg.build(SYSTEM, ("mass_matrix",))
    if not isinstance(value, dict) or value:
        with pytest.raises(kg.KanegenError) as caught:
            library.with_parameters(value)
        assert len(str(caught.value)) <= LONGEST_MESSAGE


@pytest.mark.parametrize("value", WRONG, ids=[type(value).__name__ for value in WRONG])
def test_parameters_of_a_call_are_refused_or_used(value: Any) -> None:
    library = kg.build(SYSTEM, ("mass_matrix",), parameters_by_state=True, on_status="ignore")
    try:
        library.mass_matrix(np.zeros((3, 1)), parameters=value)
    except kg.KanegenError as error:
        assert len(str(error)) <= LONGEST_MESSAGE
        assert str(error).isprintable(), repr(str(error))


@pytest.mark.parametrize(
    ("value", "text"),
    [
        ("short", "'short'"),
        (10**30, str(10**30)),
        (10**5000, "<an integer of about 5001 digits>"),
        ("a\x1b[31m\n", r"'a\x1b[31m\n'"),
        (np.eye(2), "array([[1., 0.], [0., 1.]])"),
    ],
    ids=["text", "number", "long number", "control characters", "array"],
)
def test_quoted_values(value: object, text: str) -> None:
    assert quoted(value) == text


def test_long_values_are_quoted_in_part() -> None:
    for value in ("a" * 10**7, ["b" * 1000] * 1000, {"c" * 1000: 1}, np.zeros((100, 100)), b"x" * 10**6):
        assert len(quoted(value)) <= QUOTED


def test_messages_keep_their_beginning_and_end() -> None:
    error = kg.ModelError("file.toml: " + "x" * 10**7 + " Choose another name.")
    assert len(str(error)) <= LONGEST_MESSAGE
    assert str(error).startswith("file.toml: xxx")
    assert str(error).endswith("xxx Choose another name.")


def test_many_known_names_are_listed_in_part() -> None:
    bodies = [kg.Body(f"b{k}", k, 1.0, np.eye(3), joint=HINGE) for k in range(200)]
    with pytest.raises(kg.ModelError, match=r"Known are 'b0', .*, and 170 more\."):
        kg.System("many", tuple(bodies)).with_points({"tip": ("zzzzzzzz", (0, 0, 0))})


def test_nouns_are_counted() -> None:
    assert counted(1, "body", "bodies") == "1 body"
    assert counted(2, "body", "bodies") == "2 bodies"
    assert counted(0, "freedom") == "0 freedoms"
