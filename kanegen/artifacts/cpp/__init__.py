"""The artifact "cpp": a class in C++17 whose methods are the generated functions, in headers alone.

`tables` has the constants beside the class, `methods` its methods.
"""

from __future__ import annotations

from kanegen.artifacts.cpp.methods import Batch, Method, RolloutMethod
from kanegen.artifacts.cpp.tables import places, row_names, sizes, tables
from kanegen.artifacts.loads import with_rows_read
from kanegen.c.formats import formats
from kanegen.c.interface import PREPARE
from kanegen.c.source import Source
from kanegen.c.templates import fill
from kanegen.model.identifiers import identifiers
from kanegen.model.quoting import c_comment, c_name
from kanegen.program.ir import PREPARED

VIEWS = "kanegen_views.hpp"
"""Header of the views, which is the same for all models."""


def cpp(source: Source) -> dict[str, str]:
    """Return `<model>.hpp` and the header of views, by their names."""
    model, kinds = source.model, formats(source.variant)
    functions = [with_rows_read(one, model, c_comment) for one in source.functions if one.name != PREPARE]
    prepared = [array.size for f in source.functions if f.name == PREPARE for array in f.outputs]
    text = fill(
        "artifacts/cpp/model.hpp",
        model=model,
        prefix=model.prefix,
        about=_about(source),
        number=kinds.storage.c_type,
        parameter_type=kinds.parameters.c_type,
        prepared_type=kinds.of(PREPARED).c_type,
        prepared=sum(prepared),
        first=functions[0],
        first_parameter=next(iter(identifiers([name for name, _ in model.parameters], "c")), ""),
        has_batches=source.has_batches,
        rows=row_names(source),
        may_not_converge=source.may_not_converge,
        sizes=sizes(source),
        places=places(source),
        tables=list(tables(source, kinds)),
        prepare_batch=[
            Batch(function, model.name, kinds)
            for function in source.functions
            if function.name == PREPARE and function.has_batch
        ],
        rollouts=[RolloutMethod.of(rollout, source, kinds) for rollout in source.rollouts],
        methods=[Method.of(function, source, kinds) for function in functions],
    )
    return {f"{model.name}.hpp": text, VIEWS: fill("artifacts/cpp/kanegen_views.hpp")}


def _about(source: Source) -> str:
    """Return a sentence on the class."""
    shown = c_name(source.model.shown)
    if source.model.parameters:
        return f"The model {shown} with its run-time parameters, and with what depends on them alone."
    return f"The model {shown}. It holds no numbers: they are all in the code."
