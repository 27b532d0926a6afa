"""The artifact "description": members at the places of their names in C and C++, and JSON that is true."""

import functools
import json
import re

import jsonschema
import numpy as np
import pytest

import kanegen as kg
from kanegen.artifacts.model_fields import model_fields
from kanegen.c import description
from kanegen.c.element_names import names_of_elements
from kanegen.model.identifiers import RESERVED
from kanegen.recursion.outputs import DERIVATIVES, OUTPUTS, available
from tests.support import pages
from tests.support.c_compilers import CPP, WARNINGS, C, code, run
from tests.support.handmade import source as handmade
from tests.support.paths import MODELS, ROOT
from tests.support.prescribed_trees import tree as prescribed_tree
from tests.support.random_trees import everything
from tests.support.strange_names import strange

SCHEMA = json.loads((ROOT / "docs" / "embedding" / "description.schema.json").read_text(encoding="utf-8"))
SYSTEMS = {
    "parameters": lambda: kg.load(MODELS / "double_pendulum.toml"),
    "quaternion": lambda: kg.load(MODELS / "satellite.toml"),
    "loads": lambda: kg.load(MODELS / "cart_pole.toml"),
    "points": lambda: kg.load(MODELS / "panda_arm.toml"),
    "everything": lambda: everything(2, 2),
    "strange": strange,
}


@functools.cache
def generated(name, precision="double"):
    return kg.generate(SYSTEMS[name](), artifacts="description", precision=precision)


def fields_of(source):
    return json.loads(source.files[f"{source.model.name}.json"])


def members(fields):
    """Return the path of every member, with the type that it is in and its place there."""
    groups = {
        "coordinates": [one["member"] for one in fields["coordinates"]],
        "speeds": [one["member"] for one in fields["freedoms"]],
        "parameters": [one["member"] for one in fields["parameters"]],
    }
    return [(kind, f"named.{one}", i) for kind, found in groups.items() for i, one in enumerate(found)]


def program(source, further=()):
    """Return a program that prints where members lie in their arrays, and the description."""
    name = source.model.name
    lines = []
    for kind, path, place in [*members(fields_of(source)), *further]:
        lines.append(f"    {{ {name}_{kind} one; char *p = (char *)&one.{path};")
        lines.append(f"      if (p != (char *)&one.array[{place}]) {{ wrong++; }} }}")
    checks = "\n".join(lines)
    return f"""#include <stdio.h>
#include "{name}_description.h"
int main(void)
{{
    int wrong = 0;
    {name}_state state;
    if ((char *)&state != (char *)state.x.array) {{ wrong++; }}
    if ((char *)(state.x.array + {source.model.prefix}_COORDINATES) != (char *)state.y.array) {{ wrong++; }}
{checks}
    printf("%d\\n%s\\n", wrong, {name}_describe());
    return 0;
}}
"""


def compiled(source, text, folder, standards):
    """Compile a program in C and C++ and run it; return what it prints each time."""
    source.write(folder)
    (folder / "use.c").write_text(text)
    printed = []
    for command, standard in standards:
        flags = [f for f in WARNINGS if "prototypes" not in f] if "++" in standard else WARNINGS
        language = ("-x", "c++") if "++" in standard else ()
        run(*command, f"-std={standard}", *flags, *language, "use.c", "-o", "use", folder=folder)
        printed.append(run("./use", folder=folder))
    return printed


slow = pytest.mark.slow
EVERYWHERE = [(C["gcc"], "c99"), (C["clang"], "c11"), (CPP["g++"], "c++98"), (CPP["clang++"], "c++20")]


@pytest.mark.parametrize(
    ("name", "precision"),
    [
        *((name, "double") for name in ("parameters", "strange")),
        *(
            pytest.param(name, "double", marks=slow)
            for name in ("quaternion", "loads", "points", "everything")
        ),
        pytest.param("loads", "float", marks=slow),
        pytest.param("parameters", "double-double", marks=slow),
    ],
)
def test_members_lie_at_the_places_of_their_names(name, precision, tmp_path):
    source = generated(name, precision)
    standards = EVERYWHERE if name == "strange" else EVERYWHERE[:1]
    further = []
    if name == "strange":
        further = [
            ("body_vectors", "named.name.y", 1),
            ("body_vectors", "named.a_b_2.x", 3),
            ("body_vectors", "named.a_b.z", 8),
            ("point_vectors", "named.name.x", 0),
            ("point_vectors", "named.name_2.z", 5),
        ]
    for printed in compiled(source, program(source, further), tmp_path / "c", standards):
        wrong, text = printed.splitlines()
        assert wrong == "0"
        fields = fields_of(source)
        del fields["//"]
        assert json.loads(text) == fields


def test_prescribed_motion_has_members_too(tmp_path):
    source = kg.generate(prescribed_tree("rates", 1), artifacts="description")
    p = len(source.model.prescribed)
    first = (
        source.files[f"{source.model.name}_description.h"].partition("values;")[0].rpartition("double ")[2]
    )
    further = [
        ("prescribed_motion", f"named.{row}.{first.split(',')[0].split(';')[0].strip()}", i * p)
        for i, row in enumerate(("values", "rates", "second_derivatives"))
    ]
    (printed,) = compiled(source, program(source, further), tmp_path / "c", EVERYWHERE[:1])
    assert printed.splitlines()[0] == "0"


def test_a_structure_is_the_argument_of_a_function(tmp_path):
    """Numbers that are set by name reach the functions, and results are read by name."""
    system = SYSTEMS["parameters"]()
    source = kg.generate(system, ["forward_dynamics"], artifacts="description")
    text = """#include <stdio.h>
#include "double_pendulum_description.h"
int main(void)
{
    double_pendulum_parameters parameters = DOUBLE_PENDULUM_PARAMETER_DEFAULTS;
    double_pendulum_state state = { { { 0.0, 0.0 } }, { { 0.0, 0.0 } } };
    double_pendulum_speeds tau = { { 0.0, 0.0 } }, ydot;
    double prepared[DOUBLE_PENDULUM_PREPARED];
    int status;
    parameters.named.m2 = 0.75;
    state.x.named.q1 = 0.3;
    state.y.array[DOUBLE_PENDULUM_Y_q2] = -0.2;
    tau.named.q2 = 1.5;
    if (double_pendulum_prepare(parameters.array, prepared) != 0) { return 1; }
    status = double_pendulum_forward_dynamics(prepared, state.x.array, state.y.array, tau.array, ydot.array);
    if (status != 0) { return 1; }
    printf("%.17g %.17g\\n", ydot.named.q1, ydot.named.q2);
    return 0;
}
"""
    source.write(tmp_path / "c")
    (tmp_path / "c" / "use.c").write_text(text)
    run(
        "gcc",
        "-std=c99",
        "-ffp-contract=off",
        *WARNINGS,
        "use.c",
        *code("double_pendulum"),
        "-o",
        "use",
        folder=tmp_path / "c",
    )
    found = [float(word) for word in run("./use", folder=tmp_path / "c").split()]
    library = kg.build(system.with_parameters({"m2": 0.75}), ["forward_dynamics"])
    assert found == list(library.forward_dynamics([0.3, 0.0], [0.0, -0.2], [0.0, 1.5]))


def test_headers_are_ascii_in_lines_of_110_columns():
    for name in ("strange", "parameters"):
        text = generated(name).files[f"{generated(name).model.name}_description.h"]
        assert text.isascii()
        assert name == "strange" or max(map(len, text.splitlines())) <= 110  # a name may be long
        assert not re.search(r"[ \t]$|\n\n\n", text, re.MULTILINE)


def test_padding_does_not_compile(tmp_path):
    source = generated("parameters")
    text = source.files["double_pendulum_description.h"].replace(
        "double q2; /* rad */", "float q2; /* rad */"
    )
    (tmp_path / "double_pendulum.h").write_text(source.files["double_pendulum.h"])
    (tmp_path / "use.c").write_text(text.replace("double array[2];", "double array[3];", 1))
    with pytest.raises(AssertionError, match="coordinates_has_no_padding"):
        run("gcc", "-std=c99", "-c", "use.c", folder=tmp_path)


@pytest.mark.parametrize("name", SYSTEMS)
def test_the_fields_fit_the_schema_and_the_system(name):
    system, fields = SYSTEMS[name](), fields_of(generated(name))
    jsonschema.validate(fields, SCHEMA, cls=jsonschema.Draft202012Validator)
    assert [one["name"] for one in fields["coordinates"]] == list(system.coordinate_names)
    assert [one["name"] for one in fields["freedoms"]] == list(system.freedom_names)
    assert [one["name"] for one in fields["bodies"]] == [body.name for body in system.bodies]
    assert {p["name"]: p["default"] for p in fields["parameters"]} == {
        p.name: p.value for p in system.parameters
    }
    assert fields["title"] == system.name
    assert fields["status"]["not_finite"] == len(system.freedoms) + 1
    for function in fields["functions"]:
        assert {*function["inputs"], *function["outputs"]} <= set(fields["arrays"])


@pytest.mark.parametrize("name", ["outputs", "rollout"])
def test_every_output_fits_the_schema(name):
    if name == "rollout":
        source = kg.generate(SYSTEMS["parameters"](), ["rollout_rk4"], artifacts="description")
    else:
        system = SYSTEMS["parameters"]().with_points({"tip": ("lower", (1, 0, 0))})
        outputs = [one for one in available(system) if "derivatives" not in one]
        further = ["mass_center_derivatives", "point_velocities_derivatives"]
        source = kg.generate(system, [*outputs, *further], artifacts="description")
    fields = fields_of(source)
    jsonschema.validate(fields, SCHEMA, cls=jsonschema.Draft202012Validator)
    assert [one["name"] for one in fields["rollouts"]] == ["rollout_rk4"] * (name == "rollout")
    for array in fields["arrays"].values():
        pairs = zip(array["shape"], array["elements"], strict=True)
        assert [size if names is None else len(names) for size, names in pairs] == array["shape"]


def test_limits_are_numbers_or_null():
    fields = fields_of(generated("strange"))
    assert [one["lower"] for one in fields["coordinates"]] == [-1.5, None, None]
    assert [one["upper"] for one in fields["coordinates"]] == [1.5, None, None]
    assert [one["effort_limit"] for one in fields["freedoms"]] == [87.0, None, None]
    assert [one["speed_limit"] for one in fields["freedoms"]] == [None, None, None]


def test_names_of_elements_are_those_by_which_results_are_read():
    """Derivatives have a column for each variable, and rows of poses are those of the frames."""
    system = SYSTEMS["parameters"]()
    source = kg.generate(system, ["forward_dynamics_derivatives", "body_poses"])
    arrays = {array.name: array for function in source.functions for array in function.outputs}
    rows, columns = names_of_elements(arrays["forward_dynamics_derivatives"], source.model)
    assert rows == ("q1", "q2")
    assert columns[:7] == ("x q1", "x q2", "y q1", "y q2", "tau q1", "tau q2", "parameters g")
    library = kg.build(system, ["forward_dynamics_derivatives"])
    for name, part in library.derivative_columns("forward_dynamics_derivatives").items():
        assert {one.split()[0] for one in np.array(columns)[part]} == {name}
    assert names_of_elements(arrays["body_poses"], source.model) == (system.pose_names, (), ())


@pytest.mark.parametrize("seed", [2, 3])
def test_every_column_of_derivatives_has_the_name_of_its_variable(seed):
    system = everything(seed, 3)
    model = description(system)
    for name in set(available(system)).intersection(DERIVATIVES):
        *_, columns = names_of_elements(OUTPUTS[name].array(system), model)
        parts = DERIVATIVES[name].columns_of(system)
        assert len(columns) == max(part.stop for part in parts.values())
        assert all({one.split()[0] for one in columns[part]} == {by} for by, part in parts.items())


def test_code_without_a_system_has_a_description_too():
    jsonschema.validate(json.loads(json.dumps(model_fields(handmade()))), SCHEMA)


def test_members_of_strange_names_are_identifiers():
    fields = fields_of(generated("strange"))
    found = [one["member"] for one in (*fields["coordinates"], *fields["parameters"])]
    assert found == ["for_", "a_b", "errno_", "I_"]
    assert not set(found) & RESERVED["c"]


@pytest.mark.slow
def test_the_page_runs(tmp_path):
    folder = pages.copy_of_checkout(tmp_path)
    for block in pages.fenced("embedding/description"):
        if block.file:
            (folder / block.file).write_text(block.text)
    for block in pages.blocks("embedding/description", "console"):
        pages.run_console(block, folder)
