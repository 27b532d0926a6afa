"""The target CUDA: bits of the kernels on the processor, NVIDIA's compiler, statuses, and what is refused."""

import ctypes
import re
import subprocess

import numpy as np
import pytest

import kanegen as kg
from benchmarks.cuda.nvrtc import compile_cuda
from kanegen.c import render
from kanegen.c.cuda import Cuda, teams
from kanegen.c.formats import formats
from kanegen.errors import ModelError, OptionError
from kanegen.options import Variant
from kanegen.program.ir import Module
from tests.support.c_compilers import C, run
from tests.support.cuda import build, on_processor
from tests.support.handmade import description
from tests.support.pages import files
from tests.support.paths import MODELS
from tests.support.random_trees import everything
from tests.support.robots import robot_file
from tests.support.wasm import bits, inputs_of

OUTPUTS = ("mass_matrix", "forcing", "forward_dynamics")


def of_c(source, folder):
    """The functions for one state of a source in C, compiled."""
    source.write(folder)
    name = source.model.name
    command = [*C["gcc"], "-std=c99", "-O0", "-ffp-contract=off", "-shared", "-fPIC"]
    subprocess.run([*command, f"{name}.c", "-o", f"{name}.so", "-lm"], cwd=folder, check=True)
    return ctypes.CDLL(str(folder / f"{name}.so"))


def results_of_c(source, library, function, inputs, count):
    """Outputs and statuses of a function of C for states that are rows of `inputs`."""
    of = formats(source.variant).of
    outputs = {a.name: np.full((count, *a.shape), np.nan, of(a.name).dtype) for a in function.outputs}
    call = getattr(library, f"{source.model.name}_{function.name}")
    statuses = []
    for k in range(count):
        rows = [np.ascontiguousarray(inputs[a.name][k]) for a in function.inputs]
        rows += [outputs[a.name][k] for a in function.outputs]
        statuses.append(call(*(ctypes.c_void_p(row.ctypes.data) for row in rows)))
    return outputs, statuses


def require_same_bits(
    system, folder, count, outputs=OUTPUTS, compiler="g++", nan=(), target="cuda", flags=(), **choices
):
    """Compare every function on the processor with that of C, outputs and statuses, bit by bit."""
    c = kg.generate(system, outputs, batches=False, **choices)
    library = of_c(c, folder / "c")
    cuda = kg.generate(system, outputs, target=target, **choices)
    kernels = on_processor(cuda, folder / "cuda", compiler, *flags)
    of = formats(c.variant).of
    prepared = None
    for function in c.functions:
        inputs = inputs_of(system, function, of("x").dtype, count)
        if function.name == "prepare":
            usual = np.array([parameter.value for parameter in system.parameters], of("parameters").dtype)
            inputs = {"parameters": np.tile(usual, (count, 1))}
        elif prepared is not None:
            inputs["prepared"] = np.tile(prepared, (count, 1))
        if "x" in inputs:
            inputs["x"][list(nan)] = np.nan
        expected, statuses = results_of_c(c, library, function, inputs, count)
        common = {name: inputs[name][:1] for name in ("parameters", "prepared") if name in inputs}
        found, status = kernels.call(function.name, count, stride=count + 3, **{**inputs, **common})
        if function.name == "prepare":
            prepared = found["prepared"][0]
            assert (bits(prepared) == bits(expected["prepared"][0])).all()
            continue
        # Of several conditions that fail, those of parts are not tested in the order of the whole.
        failed = np.array(statuses) > 0
        assert (status[~failed] == np.array(statuses)[~failed]).all(), function.name
        assert (status[failed] > 0).all(), function.name
        assert function.name != "forward_dynamics" or all(statuses[k] != 0 for k in nan)
        for name, values in expected.items():
            assert (bits(found[name]) == bits(values)).all(), f"{function.name}: {name}"


@pytest.mark.parametrize(
    ("model", "count", "choices"),
    [
        pytest.param("panda_arm", 33, {}, marks=pytest.mark.slow),
        ("double_pendulum", 129, {"precision": "float"}),
        ("satellite", 7, {"tier": Variant(precision="float", storage="double")}),
    ],
)
def test_kernels_have_the_bits_of_c(tmp_path, model, count, choices):
    """Kernels run on the processor: states that share parameters, quaternions, loads, several precisions."""
    system = kg.load(MODELS / f"{model}.toml")
    require_same_bits(system, tmp_path, count, ("forward_dynamics",), nan=(0, count - 1), **choices)


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["double", "float"])
@pytest.mark.parametrize("model", ["eight_body", "gantry_crane", "quarter_car", "spinning_top", "satellite"])
def test_kernels_of_all_models_have_the_bits_of_c(tmp_path, model, precision):
    system = kg.load(MODELS / f"{model}.toml")
    require_same_bits(system, tmp_path, 5, OUTPUTS, "clang++", nan=(3,), precision=precision)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_kernels_of_random_trees_have_the_bits_of_c(tmp_path, seed):
    """Force elements with all functions, couplings, contacts, motors, prescribed freedoms and parameters."""
    require_same_bits(everything(seed), tmp_path, 3, precision=("double", "float")[seed % 2])


def test_long_functions_consist_of_parts(tmp_path):
    """Parts leave values in a workspace, and have the bits of the whole."""
    system = kg.load(MODELS / "six_revolute_arm.toml")
    require_same_bits(system, tmp_path, 3, ("forward_dynamics",), target=Cuda(longest_part=200))
    assert "__noinline__" in (tmp_path / "cuda" / "six_revolute_arm.cuh").read_text()


@pytest.mark.parametrize(("count", "flags"), [(33, ()), (1, ("-DKANEGEN_SHIM_BACKWARDS",))])
def test_warps_that_share_the_work(tmp_path, monkeypatch, count, flags):
    """Two warps compute a state together, in either order between barriers; threads may repeat a state."""
    monkeypatch.setattr(teams, "REGISTER_BYTES", 0)
    monkeypatch.setattr(teams, "GAIN", 10.0)
    system = kg.load(MODELS / "satellite.toml")
    nan = (count - 1,) if count > 1 else ()
    require_same_bits(system, tmp_path, count, ("forward_dynamics",), nan=nan, flags=flags)
    assert "satellite_forward_dynamics_warp_2" in (tmp_path / "cuda" / "satellite.cu").read_text()


@pytest.mark.slow
@pytest.mark.parametrize("precision", ["double", "float"])
def test_a_quadruped(tmp_path, precision):
    """In double precision the values of a quadruped do not fit in the registers of a thread."""
    system = kg.load(robot_file("go2"), floating_base=True)
    require_same_bits(system, tmp_path, 33, ("forward_dynamics",), nan=(32,), precision=precision)
    text = (tmp_path / "cuda" / f"{system.name}.cu").read_text()
    assert ("forward_dynamics_warp_2" in text) == (precision == "double")
    files = {path.name: path.read_text() for path in (tmp_path / "cuda").glob("*.cu*")}
    options = ("--fmad=false", "--ptxas-options=-v")
    assert not compile_cuda(files, f"{system.name}.cu", "sm_90", *options).messages


@pytest.mark.parametrize("count", [0, 1, 31, 128, 257])
def test_every_number_of_states(small, count):
    """Numbers behind the last state stay as they are, as `call` asserts; without states nothing starts."""
    kernels = small
    rng = np.random.default_rng(count)
    x, y, tau = rng.normal(size=(3, count, 2))
    found, status = kernels.call("forward_dynamics", count, stride=count + 1, x=x, y=y, tau=tau)
    one = [kernels.call("forward_dynamics", 1, x=a, y=b, tau=c)[0] for a, b, c in zip(x, y, tau, strict=True)]
    assert (found["acceleration"] == np.reshape([each["acceleration"] for each in one], (-1, 2))).all()
    assert (status == 0).all()
    rows, _ = kernels.call("forward_dynamics", count, rows=True, x=x, y=y, tau=tau)
    assert (rows["acceleration"] == found["acceleration"]).all()


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    system = kg.load(MODELS / "planar_pendulum.toml")
    source = kg.generate(system, ["forward_dynamics"], target="cuda")
    return on_processor(source, tmp_path_factory.mktemp("cuda"))


def test_parameters_by_state(tmp_path):
    """Each state has its own parameters, and a column of the array `prepared`."""
    system = kg.load(MODELS / "double_pendulum.toml")
    outputs = ["forward_dynamics"]
    source = kg.generate(system, outputs, target="cuda", parameters_by_state=True)
    kernels = on_processor(source, tmp_path / "cuda")
    library = kg.build(system, outputs, parameters_by_state=True)
    rng = np.random.default_rng(2)
    x, y, tau = rng.normal(size=(3, 40, 2))
    parameters = rng.uniform(0.5, 1.5, (40, 5))
    prepared, _ = kernels.call("prepare", 40, parameters=parameters)
    found, _ = kernels.call("forward_dynamics", 40, x=x, y=y, tau=tau, prepared=prepared["prepared"])
    expected = library.forward_dynamics(x, y, tau, parameters=parameters)
    assert (bits(found["acceleration"]) == bits(expected)).all()


@pytest.mark.parametrize(
    ("model", "architecture", "choices"),
    [
        ("panda_arm", "sm_90", {"precision": "float"}),
        ("satellite", "sm_80", {}),
    ],
)
def test_the_compiler_of_nvidia(model, architecture, choices):
    """NVRTC compiles the kernels, without a warning."""
    outputs = OUTPUTS if model == "satellite" else ("forward_dynamics",)
    source = kg.generate(kg.load(MODELS / f"{model}.toml"), outputs, target="cuda", **choices)
    compiled = compile_cuda(source.files, f"{model}.cu", architecture, "--fmad=false", "--ptxas-options=-v")
    assert not compiled.messages
    usage = compiled.usage[f"{model}_forward_dynamics_kernel"]
    assert (usage.stores, usage.loads) == (0, 0)
    assert usage.registers <= 255


@pytest.mark.slow
@pytest.mark.parametrize("architecture", ["sm_80", "sm_90"])
@pytest.mark.parametrize("seed", range(2))
def test_the_compiler_of_nvidia_and_random_trees(seed, architecture):
    source = kg.generate(everything(seed), OUTPUTS, target="cuda", precision=("double", "float")[seed])
    compiled = compile_cuda(source.files, "everything.cu", architecture, "--fmad=false", "--ptxas-options=-v")
    assert not compiled.messages


@pytest.mark.parametrize(
    ("choices", "message"),
    [
        ({"precision": "double-double"}, "precision 'double-double' is not for GPUs. Choose 'double' or"),
        ({"precision": "long double"}, "precision 'long double' is not for GPUs"),
        ({"tier": Variant(storage="long double")}, "storage 'long double' is not for GPUs"),
        ({"tier": "fast"}, "are flags of compilers for processors. Generate strict code"),
        ({"tier": Variant(machine="native")}, "machine 'native' is a choice of processors, not of GPUs"),
        ({"tier": Variant(machine="multiversioned")}, "machine 'multiversioned' is a choice of processors"),
        ({"batches": False}, "its functions are for many states"),
        ({"outputs": ["rollout_rk4"]}, "it has no rollout_rk4. Make the steps in a kernel"),
        ({"artifacts": ["fmi3"]}, r"fmi3: it is for C, not for cuda\. Leave it out, or leave out the target"),
        ({"artifacts": ["rust"]}, r"rust: it is for C, not for cuda\. Leave it out, or leave out the target"),
    ],
)
def test_what_is_refused(choices, message):
    with pytest.raises(OptionError, match=message):
        kg.generate(kg.load(MODELS / "planar_pendulum.toml"), target="cuda", **choices)


@pytest.mark.parametrize(("sincos", "has_same_bits"), [("shared", True), ("libm", False)])
def test_files_promise_the_bits_of_the_c_only_where_sines_have_them(sincos, has_same_bits):
    made = kg.generate(
        kg.load(MODELS / "planar_pendulum.toml"), ["forcing"], target="cuda", tier=Variant(sincos=sincos)
    ).files
    for name in ("planar_pendulum_cuda.h", "planar_pendulum.cu", "README.md"):
        text = made[name].replace("\n * ", " ")
        assert bool(re.search("bits (are those )?of the C for the processor", text)) is has_same_bits
        assert ("Sine and cosine are those of CUDA; their last bits differ" in text) is not has_same_bits


@pytest.mark.parametrize("name", ["kanegen_device", "kanegen_sincos"])
def test_names_that_are_refused(name):
    with pytest.raises(ModelError, match="would hide another"):
        render(description(name), Module(None, {}), {}, target="cuda")


def test_the_page(tmp_path):
    """The programs of the page: one runs on the processor, and NVRTC compiles the kernel of the other."""
    system = kg.load(MODELS / "panda_arm.toml")
    source = kg.generate(system, ["forward_dynamics"], target="cuda", precision="float")
    source.write(tmp_path)
    page = files("embedding/cuda")
    (tmp_path / "batch.cu").write_text(page["batch.cu"])
    build(tmp_path, "batch", "batch.cu", "panda_arm.cu")
    readme = (tmp_path / "README.md").read_text()
    assert all(f"`{name}`" in readme for name in source.code)
    error, status, number = run("./batch", folder=tmp_path).split()
    x = np.full(7, np.float32(0.001) * np.float32(999))
    expected = kg.build(system, ["forward_dynamics"], precision="float").forward_dynamics(x, 0 * x)
    assert (error, status) == ("0", "0")
    assert np.float32(number) == expected[0]
    assert not compile_cuda({**source.files, "euler.cu": page["euler.cu"]}, "euler.cu", "sm_90").messages


def test_parameters_on_the_page(tmp_path):
    """The program that prepares one set of parameters for all states, on the processor."""
    system = kg.load(MODELS / "double_pendulum.toml")
    kg.generate(system, ["forward_dynamics"], target="cuda").write(tmp_path)
    (tmp_path / "prepare.cu").write_text(files("embedding/cuda")["prepare.cu"])
    build(tmp_path, "prepare", "prepare.cu", "double_pendulum.cu")
    found = [float(number) for number in run("./prepare", folder=tmp_path).split()]
    library = kg.build(system, ["forward_dynamics"])
    assert found == library.forward_dynamics([0.3, -0.2], [0, 0], parameters={"m1": 2.0}).tolist()
