"""Generated functions in PyTorch: values, gradients, batches, compiled code, statuses and bad input.

Gradients are compared with differences by `torch.autograd.gradcheck`, values and bits with the same C called
from NumPy, which other tests compare with the reference.
"""

from __future__ import annotations

import importlib
import pickle
from functools import partial
from typing import Any

import numpy as np
import pytest

import kanegen as kg
from kanegen.errors import ArrayError, KanegenWarning, ModelError, OptionError, StatusError
from kanegen.interop.products import ALONG, GRADIENT, VALUE, products_of
from kanegen.options import Variant
from kanegen.reference.states import random_states
from tests.support.pages import blocks
from tests.support.paths import MODELS, ROOT
from tests.support.random_trees import everything

pytestmark = [
    pytest.mark.embed("torch"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning:torch"),
    pytest.mark.filterwarnings("ignore:`torch.jit.script`:FutureWarning"),  # of forward mode in 2.15
]

QUICK = "-O1 -ffp-contract=off"
OUTPUTS = ("forward_dynamics", "inverse_dynamics", "kinetic_energy", "mass_matrix", "step_rk4")


@pytest.fixture(scope="module")
def torch() -> Any:
    """PyTorch, imported only where it is there."""
    return importlib.import_module("torch")


def functions(*given: Any, **options: Any) -> Any:
    return importlib.import_module("kanegen.interop.torch").functions(*given, **options)


def made(name: str, outputs: Any = ("forward_dynamics",), **options: Any) -> Any:
    return functions(kg.load(MODELS / f"{name}.toml"), outputs, flags=QUICK, **options)


@pytest.fixture(scope="module")
def pendulum() -> Any:
    return made("double_pendulum", OUTPUTS)


@pytest.fixture(scope="module")
def jacobians() -> Any:
    """Functions of the double pendulum whose derivatives are whole Jacobians alone."""
    names = ("forward_dynamics", "inverse_dynamics", "mass_matrix")
    return made("double_pendulum", (*names, *(f"{one}_derivatives" for one in names[:2])), derivatives=False)


@pytest.fixture(scope="module")
def twice() -> Any:
    """Functions of the double pendulum with second derivatives."""
    names = ("forward_dynamics", "inverse_dynamics", "forcing")
    return made("double_pendulum", (*names, *(f"{name}_hvp" for name in names)))


@pytest.fixture(scope="module")
def satellite() -> Any:
    return made("satellite", ("forward_dynamics", "coordinate_rates", "momentum"))


def numbers(torch: Any, *shape: int, seed: int = 0, grad: bool = True) -> Any:
    """Return random numbers of doubles, which ask for gradients."""
    found = np.random.default_rng(seed).normal(size=shape)
    return torch.tensor(found, requires_grad=grad)


def test_values_have_the_bits_of_the_library(torch: Any, pendulum: Any) -> None:
    x, y, tau = numbers(torch, 3, 1, 2), numbers(torch, 4, 2, seed=1), numbers(torch, 2, seed=2)
    found = pendulum.forward_dynamics(x, y, tau).detach().numpy()
    expected = pendulum.library.ufunc("forward_dynamics")(*(one.detach().numpy() for one in (x, y, tau)))
    assert found.shape == (3, 4, 2)
    assert np.array_equal(found, expected)
    strided = torch.tensor(np.random.default_rng(1).normal(size=(2, 6)))[:, ::2].T  # (3, 2)
    plain = strided.contiguous()
    assert torch.equal(pendulum.mass_matrix(strided), pendulum.mass_matrix(plain))
    following = pendulum.step_rk4(plain, plain, step=0.01)
    again = pendulum.library.step(plain.numpy(), plain.numpy(), step=np.full(3, 0.01))
    assert all(np.array_equal(one.numpy(), other) for one, other in zip(following, again, strict=True))
    assert pendulum.kinetic_energy(plain[0], plain[0]).shape == ()


def test_gradients_of_a_pendulum(torch: Any, pendulum: Any) -> None:
    """By the state, {tau}, accelerations and parameters, of a vector, a scalar and of two results."""
    x, y, tau = numbers(torch, 3, 1, 2), numbers(torch, 2, 2, seed=1), numbers(torch, 2, seed=2)
    usual = torch.tensor([*pendulum.library.parameters.values()], dtype=torch.float64)
    parameters = (usual * torch.linspace(0.9, 1.1, 15).reshape(3, 1, 5).double()).requires_grad_()
    check = partial(torch.autograd.gradcheck, check_forward_ad=True)
    assert check(lambda *a: pendulum.forward_dynamics(*a[:3], parameters=a[3]), (x, y, tau, parameters))
    assert check(pendulum.inverse_dynamics, (x, y, tau))
    assert check(lambda *a: pendulum.kinetic_energy(*a[:2], parameters=a[2]), (x, y, parameters))
    assert check(lambda *a: pendulum.step_rk4(*a[:3], step=0.1, parameters=a[3]), (x, y, tau, parameters))


def test_products_give_what_jacobians_give(torch: Any, pendulum: Any, jacobians: Any) -> None:
    """Gradients and derivatives along directions, to rounding."""
    x, y, tau = numbers(torch, 3, 1, 2), numbers(torch, 2, 2, seed=1), numbers(torch, 2, seed=2)
    usual = torch.tensor([*pendulum.library.parameters.values()], dtype=torch.float64, requires_grad=True)
    along = tuple(torch.randn_like(one) for one in (x, y, tau, usual))
    weights = numbers(torch, 3, 2, 2, seed=3, grad=False)
    for name in ("forward_dynamics", "inverse_dynamics"):
        found = []
        for of in (pendulum, jacobians):

            def work(*a: Any, of: Any = of, name: str = name) -> Any:
                return getattr(of, name)(*a[:3], parameters=a[3])

            _, change = torch.func.jvp(work, (x, y, tau, usual), along)
            found.append((change, *torch.autograd.grad(work(x, y, tau, usual), (x, y, tau, usual), weights)))
        for one, other in zip(*found, strict=True):
            assert torch.allclose(one, other, rtol=1e-13, atol=1e-13 * other.abs().max().item())


def test_second_derivatives(torch: Any, twice: Any) -> None:
    x, y, tau = numbers(torch, 2, 1, 2), numbers(torch, 2, 2, seed=1), numbers(torch, 2, seed=2)
    usual = torch.tensor([*twice.library.parameters.values()], dtype=torch.float64, requires_grad=True)
    check = torch.autograd.gradgradcheck
    for name in ("forward_dynamics", "inverse_dynamics"):
        function = getattr(twice, name)
        assert check(
            lambda *a, f=function: f(*a[:3], parameters=a[3]),
            (x, y, tau, usual),
            check_fwd_over_rev=True,
            check_rev_over_rev=True,
        )
    assert check(lambda *a: twice.forcing(*a[:2], parameters=a[2]), (x, y, usual))
    weights, along = numbers(torch, 2, seed=4), numbers(torch, 11, seed=5)
    first = partial(torch.autograd.gradcheck, check_forward_ad=True)
    assert first(lambda x, w: twice.forward_dynamics_vjp(x, y, w, tau), (x, weights))
    assert first(lambda x, d: twice.forward_dynamics_jvp(x, y, d, tau), (x, along))
    x, y, tau = x.detach(), y.detach(), tau.detach()
    assert check(lambda w: twice.forward_dynamics_vjp(x, y, w, tau), (weights,))
    assert check(lambda d: twice.forward_dynamics_jvp(x, y, d, tau), (along,))
    assert first(lambda w, d: twice.forward_dynamics_hvp(x, y, w, d, tau), (weights, along))


def test_every_order_of_modes_gives_the_same_hessian(torch: Any, twice: Any) -> None:
    x, y = numbers(torch, 5, 2, grad=False), numbers(torch, 2, seed=1, grad=False)
    fwd, rev = torch.func.jacfwd, torch.func.jacrev

    def total(x: Any) -> Any:
        return (twice.forward_dynamics(x, y) * torch.tensor([1.0, -2.0])).sum()

    right = torch.func.vmap(torch.func.hessian(total))(x)
    for outer, inner in ((fwd, fwd), (rev, fwd), (rev, rev)):
        found = torch.func.vmap(outer(inner(total)))(x)
        assert torch.allclose(found, right, rtol=1e-12, atol=1e-12)
    inputs = x[0].clone().requires_grad_()
    plain = torch.autograd.functional.hessian(total, inputs)
    assert torch.allclose(plain, right[0], rtol=1e-12, atol=1e-12)


def test_the_way_of_fewest_operations(torch: Any) -> None:
    """A product for one gradient; for a Jacobian, whole derivatives where these were generated."""
    every = made("scara", ("forward_dynamics", "forward_dynamics_derivatives"))
    products, form = products_of(every.library.source)["forward_dynamics"]
    assert not any(products.takes_jacobian(one, 1) for one in (ALONG, GRADIENT))
    assert all(products.takes_jacobian(one, 4) for one in (ALONG, GRADIENT))
    assert form == VALUE
    x, y, tau = (numbers(torch, 4, seed=k) for k in range(3))
    whole = torch.tensor(
        every.library.forward_dynamics_derivatives(*(one.detach().numpy() for one in (x, y, tau)))
    )
    by = every.library.derivative_columns("forward_dynamics_derivatives")
    rows = [torch.autograd.grad(every.forward_dynamics(x, y, tau)[k], x)[0] for k in range(4)]
    scale = whole.abs().max().item()
    assert torch.allclose(torch.stack(rows), whole[:, by["x"]], rtol=1e-12, atol=1e-13 * scale)
    for mode in (torch.func.jacrev, torch.func.jacfwd):
        found = mode(every.forward_dynamics, argnums=(0, 1, 2))(x, y, tau)
        for one, name in zip(found, ("x", "y", "tau"), strict=True):
            assert torch.allclose(one, whole[:, by[name]], rtol=1e-14, atol=1e-15 * scale)


def test_gradients_over_no_states_are_zero(torch: Any, pendulum: Any) -> None:
    none, y = torch.zeros((0, 2), dtype=torch.float64, requires_grad=True), numbers(torch, 2)
    pendulum.forward_dynamics(none, y).sum().backward()
    assert none.grad.shape == (0, 2) and torch.equal(y.grad, torch.zeros_like(y))
    pendulum.kinetic_energy(none, y).sum().backward()
    assert torch.equal(y.grad, torch.zeros_like(y))


def test_gradients_with_quaternions_and_loads(torch: Any, satellite: Any) -> None:
    x, y = numbers(torch, 2, 9), numbers(torch, 2, 8, seed=1)
    loaded = torch.tensor(satellite.library.source.model.loaded)[:, None]
    force = numbers(torch, 3, 3, seed=2, grad=False) * loaded
    check = torch.autograd.gradcheck
    assert check(lambda x, y: satellite.forward_dynamics(x, y, force=force), (x, y), atol=1e-4)
    force.requires_grad_()
    assert check(lambda force: satellite.forward_dynamics(x, y, force=force * loaded), (force,), atol=1e-4)
    assert check(satellite.coordinate_rates, (x, y))
    assert check(satellite.momentum, (x, y))


@pytest.mark.parametrize("seed", range(3))
def test_gradients_of_random_trees(torch: Any, seed: int) -> None:
    """Every kind of joint, force elements, loads, the time and parameters."""
    system = everything(seed, 2).with_contacts([])
    found = functions(system, flags=QUICK, on_status="ignore")
    states = random_states(system, 2, seed)
    loads = {} if states.force is None else {"force": states.force, "torque": states.torque}
    named = {name: torch.tensor(value) for name, value in {**states.inputs, **loads}.items()}
    x, y = (torch.tensor(one, requires_grad=True) for one in (states.x, states.y))
    tau = numbers(torch, found.library.n)
    usual = torch.tensor([*found.library.parameters.values()], dtype=torch.float64, requires_grad=True)

    jacobian = torch.autograd.functional.jacobian

    def scaled(x: Any, y: Any, tau: Any, parameters: Any) -> Any:
        return found.forward_dynamics(x, y, tau, parameters=parameters, **named) / size

    size = found.forward_dynamics(x, y, tau, **named).detach().abs().max()
    size = size * max(1.0, *(one.abs().max().item() for one in jacobian(scaled, (x, y, tau, usual))))
    assert torch.autograd.gradcheck(scaled, (x, y, tau, usual), eps=2.0**-22, atol=1e-5)


def test_a_gradient_through_a_rollout(torch: Any, pendulum: Any) -> None:
    """Of the end by constant torques, against central differences of the rollout in C."""
    tau = torch.tensor([0.3, -0.2], dtype=torch.float64, requires_grad=True)
    x, y = torch.tensor([0.5, 0.1], dtype=torch.float64), torch.zeros(2, dtype=torch.float64)
    for _ in range(50):
        x, y = pendulum.step_rk4(x, y, tau, step=0.01)
    (slope,) = torch.autograd.grad(x.sum(), tau)
    rollout = kg.build(kg.load(MODELS / "double_pendulum.toml"), ("rollout_rk4",), flags=QUICK)

    def end(torques: Any) -> Any:
        return rollout.rollout([0.5, 0.1], [0.0, 0.0], torques, steps=50, step=0.01).x[-1].sum()

    assert abs(x.sum().item() - end([0.3, -0.2])) <= 1e-13
    h = 2.0**-14
    expected = [
        (end(tau.detach().numpy() + d) - end(tau.detach().numpy() - d)) / (2 * h) for d in h * np.eye(2)
    ]
    assert np.abs(slope.numpy() - expected).max() <= 1e-8


def test_vmap_and_derivatives_of_torch_func(torch: Any, pendulum: Any, jacobians: Any) -> None:
    x, y = numbers(torch, 5, 2, grad=False), numbers(torch, 5, 2, seed=1, grad=False)
    vmap, jacrev, grad = torch.func.vmap, torch.func.jacrev, torch.func.grad
    function = pendulum.forward_dynamics
    assert torch.equal(vmap(function)(x, y), function(x, y))
    assert torch.equal(vmap(function, in_dims=(0, None))(x, y[0]), function(x, y[0]))
    assert torch.equal(vmap(function, in_dims=(1, 0))(x.T, y), function(x, y))
    both = vmap(vmap(function, in_dims=(None, 0)), in_dims=(0, None))(x, y)
    assert torch.equal(both, function(x[:, None], y))
    by = jacobians.library.derivative_columns("forward_dynamics_derivatives")
    slopes = torch.tensor(jacobians.library.forward_dynamics_derivatives(x.numpy(), y.numpy()))
    assert torch.allclose(vmap(jacrev(function))(x, y), slopes[..., by["x"]], rtol=1e-14, atol=1e-14)
    own = vmap(grad(lambda p: function(x[0], y[0], parameters=p).sum()))
    sets = (
        torch.tensor([*pendulum.library.parameters.values()], dtype=torch.float64) * torch.ones(3, 1).double()
    )
    expected = slopes[0, :, by["parameters"]].sum(0)
    assert torch.allclose(own(sets), expected.expand(3, 5), rtol=1e-13)


@pytest.mark.filterwarnings("ignore:The .grad attribute of a Tensor:UserWarning")  # of opcheck in 2.15
def test_operators_keep_what_pytorch_asks_of_them(torch: Any, pendulum: Any) -> None:
    """`opcheck`: schema, no aliases, shapes without values, gradients, dynamic shapes of compiled code."""
    operators = importlib.import_module("kanegen.interop.torch.operators")
    x, y, tau = numbers(torch, 3, 2), numbers(torch, 2, seed=1), numbers(torch, 2, seed=2)
    parameters = torch.tensor([*pendulum.library.parameters.values()], dtype=torch.float64)
    names = [name for name in dir(torch.ops.kanegen) if "double_pendulum_forward_dynamics_" in name]
    assert operators and names
    first = min((n for n in names if n.split("_")[-2] == "dynamics"), key=lambda n: int(n.split("_")[-1]))
    operator = getattr(torch.ops.kanegen, first).default
    torch.library.opcheck(operator, (x, y, tau, parameters))
    product = next(n for n in names if "forward_dynamics_weights_" in n)
    weights = numbers(torch, 3, 2, seed=3)
    torch.library.opcheck(getattr(torch.ops.kanegen, product).default, (x, y, tau, parameters, weights))


@pytest.mark.parametrize("backend", ["aot_eager", "inductor"])
def test_compiled_code(torch: Any, pendulum: Any, backend: str) -> None:
    """The same values and gradients, in one graph."""
    torch.compiler.reset()
    x, y = numbers(torch, 3, 2), numbers(torch, 3, 2, seed=1)

    def work(x: Any, y: Any) -> Any:
        following, _ = pendulum.step_rk4(x, y, step=0.01)
        return (pendulum.forward_dynamics(following, y) * y).sum()

    compiled = torch.compile(work, fullgraph=True, backend=backend)
    assert torch.allclose(compiled(x, y), work(x, y), rtol=1e-14)
    found, expected = (torch.autograd.grad(one(x, y), (x, y)) for one in (compiled, work))
    assert all(torch.allclose(*pair, rtol=1e-12) for pair in zip(found, expected, strict=True))


def test_single_precision_and_several_models(torch: Any, pendulum: Any, satellite: Any) -> None:
    single = made("double_pendulum", precision="float")
    x, y = numbers(torch, 4, 2, grad=False).float(), numbers(torch, 4, 2, seed=1, grad=False).float()
    x.requires_grad_()
    found = single.forward_dynamics(x, y)
    assert found.dtype == torch.float32
    assert torch.allclose(found, pendulum.forward_dynamics(x.double(), y.double()).float(), rtol=1e-4)
    found.sum().backward()
    assert x.grad.dtype == torch.float32
    assert satellite.forward_dynamics(torch.eye(1, 9).double(), torch.zeros(8).double()).shape == (1, 8)
    heavy = functions(pendulum.library.with_parameters({"m2": 2.0}))
    assert not torch.equal(
        heavy.forward_dynamics(x.double(), y.double()), pendulum.forward_dynamics(x.double(), y.double())
    )
    with_mass = pendulum.forward_dynamics(x.double(), y.double(), parameters={"m2": 2.0})
    assert torch.equal(heavy.forward_dynamics(x.double(), y.double()), with_mass)
    again = pickle.loads(pickle.dumps(pendulum))
    assert torch.equal(
        again.forward_dynamics(x.double(), y.double()), pendulum.forward_dynamics(x.double(), y.double())
    )


def test_statuses(torch: Any, pendulum: Any) -> None:
    bad = torch.tensor([float("nan"), 0.0], dtype=torch.float64)
    good = torch.zeros(2, dtype=torch.float64)
    with pytest.warns(KanegenWarning, match=r"forward_dynamics: .*x\[0\] is nan"):
        assert torch.isnan(pendulum.forward_dynamics(bad, good)).any()
    strict = functions(pendulum.library.with_on_status("raise"))
    with pytest.raises(StatusError, match=r"in 1 of 2 states .*x\[0\] is nan"):
        strict.forward_dynamics(torch.stack([good, bad]), good)


def test_what_does_not_fit_says_so(torch: Any, pendulum: Any, jacobians: Any, twice: Any) -> None:
    x = numbers(torch, 2)
    with pytest.raises(OptionError, match="mass_matrix: PyTorch asks for the gradient by x"):
        pendulum.mass_matrix(x).sum().backward()
    for of in (pendulum, jacobians):
        (slope,) = torch.autograd.grad(of.forward_dynamics(x, x).sum(), x, create_graph=True)
        with pytest.raises(
            OptionError, match=r"second derivatives,? and the library .* forward_dynamics_hvp"
        ):
            slope.sum().backward()
    (slope,) = torch.autograd.grad(pendulum.kinetic_energy(x, x).sum(), x, create_graph=True)
    with pytest.raises(OptionError, match="asks for second derivatives, which are not generated"):
        slope.sum().backward()
    with pytest.raises(OptionError, match="PyTorch asks for third derivatives"):
        torch.func.jacrev(torch.func.hessian(lambda x: twice.forward_dynamics(x, x).sum()))(x)
    length = torch.tensor(0.1, dtype=torch.float64, requires_grad=True)
    with pytest.raises(OptionError, match=r"gradient by step\. There are derivatives by .*Detach"):
        pendulum.step_rk4(x, x, step=length)[0].sum().backward()
    plain = made("double_pendulum", derivatives=False)
    with pytest.raises(OptionError, match=r"built without forward_dynamics_vjp, .*Ask for one"):
        plain.forward_dynamics(x, x.detach()).sum().backward()
    some = made("double_pendulum", ("forward_dynamics", "forward_dynamics_jvp"), derivatives=False)
    with pytest.raises(OptionError, match=r"a gradient, .* without forward_dynamics_vjp\. Ask for it"):
        some.forward_dynamics(x, x.detach()).sum().backward()
    with pytest.raises(ArrayError, match=r"expected numbers of torch\.float64, got torch\.float32"):
        pendulum.forward_dynamics(x.float(), x)
    with pytest.raises(ArrayError, match=r"x: it is on meta"):
        pendulum.forward_dynamics(x.to("meta"), x)
    with pytest.raises(ArrayError, match=r"x: expected shape \(\.\.\., 2\), got \(3,\)"):
        pendulum.forward_dynamics(numbers(torch, 3), x)
    for wrong in ("a", [[1.0, 2.0], [3.0]], torch.ones(2) * 1j):
        with pytest.raises(ArrayError, match="y: expected real numbers"):
            pendulum.forward_dynamics(x, wrong)
    with pytest.raises(ArrayError, match="leading dimensions do not broadcast"):
        pendulum.forward_dynamics(numbers(torch, 3, 2), numbers(torch, 4, 2))
    with pytest.raises(OptionError, match=r"PyTorch follows motions by steps.*Take step_rk4"):
        made("double_pendulum", "rollout_rk4")
    with pytest.raises(ArrayError, match="y: missing"):
        pendulum.forward_dynamics(x)
    with pytest.raises(ArrayError, match="y: passed twice"):
        pendulum.forward_dynamics(x, x, y=x)
    with pytest.raises(ArrayError, match=r"no such argument\. Did you mean 'tau'"):
        pendulum.forward_dynamics(x, x, taw=x)
    with pytest.raises(ModelError, match="unknown parameter 'm9'"):
        pendulum.forward_dynamics(x, x, parameters={"m9": 1.0})
    with pytest.raises(AttributeError, match="without the output 'forcing'"):
        _ = pendulum.forcing
    with pytest.raises(AttributeError, match=r"there is no output 'forward_dynamic'\. Did you mean"):
        _ = pendulum.forward_dynamic
    with pytest.raises(OptionError, match="'long double', which PyTorch does not have"):
        made("double_pendulum", tier=Variant("long double"))


def test_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    namespace: dict[str, Any] = {}
    for block in blocks("embedding/torch", "python"):
        exec(block, namespace)
    assert namespace["losses"][-1] < 0.1 * namespace["losses"][0]
