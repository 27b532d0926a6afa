"""Operations of derivatives by composite bodies beside tangents alone, and the time of the default build.

python -m benchmarks.derivatives [MODEL ...]
python -m benchmarks.derivatives --build [MODEL ...]

Without --build it prints additions, multiplications and divisions of the derivatives of inverse and forward
dynamics, and those of products with derivatives of {ydot}, its value included, over those of {ydot}.
With --build it prints the time of a state in batches by portable code, by code for AVX2 and by the default of
this processor, medians of interleaved rounds, and whether all bits are equal.
"""

from __future__ import annotations

import argparse
import time
from dataclasses import replace

import numpy as np

import kanegen as kg
from benchmarks import models
from kanegen.compiler import compile_candidate, compile_module
from kanegen.lowering.accept import accept
from kanegen.lowering.conditioning import condition
from kanegen.measure.machine import Machine
from kanegen.options import STRICT, Variant
from kanegen.program.count import count
from kanegen.recursion.outputs.derivatives import PARTS
from kanegen.studies.bench.settings import DEFAULT_AVX2, keeping_bits

OUTPUTS = ("inverse_dynamics_derivatives", "forward_dynamics_derivatives")
PRODUCTS = ("jvp", "vjp", "hvp")
ARITHMETIC = ("add", "multiply", "divide")
STATES = 4096
ROUNDS = 15


def main() -> None:
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.derivatives", description=__doc__.splitlines()[0]
    )
    parser.add_argument(
        "models", nargs="*", default=["ur5", "chain6", "panda", "go2", "hyq", "eight_body"], metavar="MODEL"
    )
    parser.add_argument("--build", action="store_true", help="time the default build instead")
    options = parser.parse_args()
    for name in options.models:
        system = models.system(name)
        if options.build:
            _print_times(name, system)
        else:
            for output in OUTPUTS:
                tangents, least = _operations(system, output)
                print(f"{name} {output}: tangents alone {tangents}, as generated {least}", flush=True)
            _print_products(name, system)
    if options.build:
        print("\n".join(Machine.here().lines()))


def _operations(system: kg.System, output: str) -> tuple[int, int]:
    """Return the operations of an output by tangents alone, and of the cheapest way."""
    request = accept(system, (output,), STRICT)
    ways = condition(request)
    alone = [replace(way, methods={k: v for k, v in way.methods.items() if k not in PARTS}) for way in ways]
    least = []
    for candidates in (alone, ways):
        programs = [compile_candidate(request, way).module.functions[output] for way in candidates]
        least.append(min(sum(count(program)[kind] for kind in ARITHMETIC) for program in programs))
    return least[0], least[1]


def products(system: kg.System) -> dict[str, float]:
    """Return the operations of {ydot} and each product with its derivatives, over those of {ydot}."""
    names = [("forward_dynamics",), *(("forward_dynamics", f"forward_dynamics_{one}") for one in PRODUCTS)]
    costs = []
    for outputs in names:
        operations = compile_module(system, outputs).operations
        costs.append(sum(operations[kind] for kind in ARITHMETIC))
    return {one: cost / costs[0] for one, cost in zip(PRODUCTS, costs[1:], strict=True)}


def _print_products(name: str, system: kg.System) -> None:
    """Print the costs of products with derivatives of {ydot}."""
    ratios = ", ".join(f"{one} {ratio:.2f}" for one, ratio in products(system).items())
    print(f"{name} forward_dynamics with products, over forward_dynamics: {ratios}", flush=True)


def _print_times(name: str, system: kg.System) -> None:
    """Print the times of forward dynamics and {f} by three builds."""
    outputs = ("forward_dynamics", "forcing")
    libraries = {
        "portable": kg.build(system, outputs, tier=Variant(machine="portable")),
        "AVX2": kg.build(system, outputs, flags=keeping_bits(DEFAULT_AVX2).flags),
        "default": kg.build(system, outputs),
    }
    states = np.random.default_rng(0).uniform(-1, 1, (2, STATES, libraries["default"].n))
    for output in outputs:
        results = {one: getattr(library, output)(*states) for one, library in libraries.items()}
        times: dict[str, list[float]] = {one: [] for one in libraries}
        for _ in range(ROUNDS):
            for one, library in libraries.items():
                start = time.perf_counter()
                getattr(library, output)(*states)
                times[one].append((time.perf_counter() - start) / STATES * 1e9)
        print(f"{name} {output}, batch of {STATES}: portable {np.median(times['portable']):.0f} ns", end="")
        for one in ("AVX2", "default"):
            ratios = np.array(times["portable"]) / np.array(times[one])
            shown = f"1/{np.median(ratios):.2f} (1/{ratios.min():.2f} to 1/{ratios.max():.2f})"
            same = bool((results[one] == results["portable"]).all())
            print(f"; {one} {shown}, {'same bits' if same else 'OTHER BITS'}", end="")
        print(flush=True)


if __name__ == "__main__":
    main()
