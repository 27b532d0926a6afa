"""The target CUDA: what it refuses, its dialect, and its files."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass, replace

from kanegen.c.c99 import printed_choices
from kanegen.c.context import Context, context
from kanegen.c.cuda.dialect import CudaDialect
from kanegen.c.cuda.functions import cuda_functions
from kanegen.c.cuda.teams import WARP, WARPS, team
from kanegen.c.declarations import not_finite, prepared_places
from kanegen.c.elementary import ELEMENTARY, elementary_header
from kanegen.c.functions import printed_functions
from kanegen.c.interface import PREPARE, Function
from kanegen.c.layout import WIDTH
from kanegen.c.nomenclature import nomenclature
from kanegen.c.target import Printed, RenderInput
from kanegen.c.templates import fill
from kanegen.errors import ModelError, OptionError
from kanegen.model.names import FILES_OF_C
from kanegen.options import AUTO
from kanegen.program.precision import DOUBLE, FLOAT

THREADS = 128
"""Threads of a block: a multiple of the 32 of a warp, so few that each can have 255 registers."""

INLINE = "static __device__ __forceinline__"
"""What stands before the type of a function that device code calls."""

UNCONTRACTED = "--fmad=false"
"""The flag of nvcc and NVRTC that leaves products and sums apart."""

NUMBERS = {
    "NAN": "__int_as_float(0x7fffffff)",
    "INFINITY": "__int_as_float(0x7f800000)",
    "FLT_MAX": "3.4028234663852886e38f",
    "FLT_MIN": "1.1754943508222875e-38f",
    "DBL_MAX": "1.7976931348623157e308",
    "DBL_MIN": "2.2250738585072014e-308",
}
"""Numbers of <math.h> and <float.h>, for a compiler without these headers."""

_COMMON = "kanegen_device.cuh"


@dataclass(frozen=True)
class Cuda:
    """CUDA C++ for GPUs: a thread for each state of a batch.

    Attributes:
        name: Name of the target, as users write it.
        longest_part: Instructions of a function from which it is cut into parts.
        has_loops: False, because solutions in loops over columns become straight-line code.

    Example:
        kg.generate(kg.load("models/panda_arm.toml"), ["forward_dynamics"], target="cuda").write("build/")
    """

    name: str = "cuda"
    longest_part: int = 3200
    has_loops: bool = False

    def require_name(self, name: str) -> None:
        """Refuse the name of a header of the C library.

        Raises:
            ModelError: If `name` is reserved.
        """
        if name.lower() in FILES_OF_C:
            raise ModelError(
                f"system name {name!r}: its file would hide another of that name. Choose another name."
            )

    def dialect(self, render_input: RenderInput, function: Function) -> CudaDialect:
        """Return the statements of a device function; `prepare` computes at least in double precision."""
        formats = render_input.formats
        arithmetic = formats.preparing if function.name == PREPARE else formats.arithmetic
        kanegen_sincos = render_input.sincos is not None and arithmetic is formats.arithmetic
        return CudaDialect(formats, arithmetic, kanegen_sincos, render_input.places, has_lanes=False)

    def printed(self, render_input: RenderInput) -> Printed:
        """Return device functions, kernels and the header of the functions that launch them.

        Raises:
            OptionError: If the target lacks the precision, the semantics, the machine or an output.
        """
        _require_supported(render_input)
        model = render_input.model.name
        variables = self._context(replace(render_input, batches=False))
        files = {
            f"{model}_cuda.h": fill("cuda/model_cuda.h", **variables),
            f"{model}.cu": fill("cuda/model.cu", **variables),
            f"{model}.cuh": fill("cuda/model.cuh", **variables),
            _COMMON: fill(f"cuda/{_COMMON}", **variables),
        }
        return Printed(files | variables["numeric"], "")

    def _context(self, one_state: RenderInput) -> Context:
        """Return the variables of the templates, from the input for functions of one state."""
        printed = printed_functions(one_state, self)
        teams = {f.name: team(one_state, f, self.dialect(one_state, f)) for f in one_state.programs}
        variables = context(
            one_state.model, one_state.functions, one_state.outputs, one_state.operations, one_state.variant
        )
        device = {"device": True, "inline": INLINE, "uncontracted": UNCONTRACTED}
        called = dict.fromkeys(f.code.elementary for f in printed if f.code.elementary is not None)
        numeric = {
            f"{elementary_header(precision)}.cuh": fill(
                "c99/kanegen_elementary.h", elementary=ELEMENTARY[precision], **device
            )
            for precision in called
        }
        sincos = one_state.sincos
        if sincos is not None and any(function.code.has_sines for function in printed):
            numeric = {
                f"{sincos.header}.cuh": fill("c99/kanegen_sincos.h", **(variables | device)),
                **numeric,
            }
        return {
            **variables,
            "choices": printed_choices(one_state, printed),
            "functions": cuda_functions(one_state, printed, teams),
            "nomenclature": nomenclature(printed),
            "prepared_places": prepared_places(one_state.model, one_state.prepared),
            "shared": {name for function in one_state.functions for name in function.shared},
            "not_finite": not_finite(one_state.model),
            "bits": textwrap.wrap(_about_bits(one_state), WIDTH),
            "numbers": NUMBERS,
            "threads": THREADS,
            "warp": WARP,
            "warps": WARPS,
            "numeric": numeric,
            "headers": list(numeric),
            "device": True,
        }


def _require_supported(render_input: RenderInput) -> None:
    """Refuse what kernels do not have.

    Raises:
        OptionError: If there are no batches, or the precision, the semantics, the machine or an output are
            not for GPUs.
    """
    formats, variant = render_input.formats, render_input.variant
    if not render_input.batches:
        raise OptionError(
            "target cuda: its functions are for many states. Leave out the choice of one state."
        )
    for label, precision in (("precision", formats.arithmetic), ("storage", formats.storage)):
        if precision not in (FLOAT, DOUBLE):
            raise OptionError(
                f"target cuda: {label} {precision.name!r} is not for GPUs. Choose 'double' or 'float'."
            )
    if not variant.is_strict:
        raise OptionError(
            f"target cuda: semantics {', '.join(variant.semantics)} are flags of compilers for processors. "
            "Generate strict code, and choose --fmad, --ftz or --use_fast_math when you compile it."
        )
    if variant.machine != AUTO:
        raise OptionError(
            f"target cuda: machine {variant.machine!r} is a choice of processors, not of GPUs. Leave it out, "
            "and choose -arch when you compile the kernels."
        )
    if render_input.steps:
        raise OptionError(
            f"target cuda: it has no {', '.join(render_input.steps)}. Make the steps in a kernel that calls "
            "the functions of the .cuh file for one state, and leave these names out."
        )


def _about_bits(render_input: RenderInput) -> str:
    """Return the sentences on the bits of results and on sine and cosine."""
    same = (
        f"Without contraction of products and sums (nvcc and NVRTC {UNCONTRACTED}, clang -ffp-contract=off) "
        "every result has the bits of the C for the processor, but for the sign and the payload of a NaN"
    )
    sincos = render_input.sincos
    if sincos is None:
        return "Sine and cosine are those of CUDA; their last bits differ from those of other libraries."
    return (
        f"{same}. Sine and cosine are kanegen's own ({sincos.header}.cuh), off by at most {sincos.error}, "
        "for angles of every size."
    )


CUDA_TARGET = Cuda()
"""The target for GPUs."""
