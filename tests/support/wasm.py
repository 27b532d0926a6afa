"""Functions of a WebAssembly module, called with NumPy arrays by wasmtime, and what native ones return."""

import numpy as np
import wasmtime

from kanegen.browser.wasm import wasm_module
from kanegen.c import description
from kanegen.c.formats import formats
from kanegen.model.arguments import LOADS
from kanegen.reference.states import random_states

ALIGNMENT = 16
PAGE = 65536


class WasmLibrary:
    """The functions of a source in WebAssembly, state by state or in batches."""

    def __init__(self, source, **options):
        self.source = source
        self._store = wasmtime.Store()
        compiled = wasmtime.Module(self._store.engine, wasm_module(source, **options))
        assert not list(compiled.imports)
        self.exports = wasmtime.Instance(self._store, compiled, []).exports(self._store)
        self._memory = self.exports["memory"]
        self._formats = formats(source.variant)
        self._free = self.exports["__heap_base"].value(self._store)
        self._places = {}

    def __call__(self, name, *inputs):
        """Return the outputs of function `name` for one state, and its status."""
        function = self._function(name)
        for array, values in zip(function.inputs, inputs, strict=True):
            self._write(array.name, np.asarray(values, self._dtype(array)))
        return self._run(function, name, 1, ())

    def batch(self, name, *inputs):
        """Return the outputs of the batch form of function `name`, and its status."""
        function = self._function(name)
        count = len(inputs[-1])
        for array, values in zip(function.inputs, inputs, strict=True):
            self._write(array.name, np.ascontiguousarray(values, self._dtype(array)))
        return self._run(function, f"{name}_batch", count, (count,))

    def _function(self, name):
        return next(one for one in self.source.functions if one.name == name)

    def _dtype(self, array):
        return self._formats.of(array.name).dtype

    def _run(self, function, name, count, leading):
        sizes = {a.name: count * a.size * self._formats.of(a.name).bytes for a in function.outputs}
        places = [
            self._place(array.name, size)
            for array, size in zip(function.outputs, sizes.values(), strict=True)
        ]
        arguments = [*leading, *(self._places[a.name][0] for a in function.inputs), *places]
        status = self.exports[f"{self.source.model.name}_{name}"](self._store, *arguments)
        found = []
        for array, place in zip(function.outputs, places, strict=True):
            data = self._memory.read(self._store, place, place + sizes[array.name])
            shape = (
                *((count,) if leading else ()),
                *array.shape,
                *self._formats.of(array.name).trailing_shape,
            )
            found.append(np.frombuffer(bytes(data), self._dtype(array)).reshape(shape))
        return *found, status

    def _write(self, name, values):
        self._memory.write(self._store, values.tobytes(), self._place(name, values.nbytes))

    def _place(self, name, size):
        """The address of an array, which moves to the end of the memory when the array grows."""
        address, room = self._places.get(name, (0, -1))
        if size > room:
            address = -(-self._free // ALIGNMENT) * ALIGNMENT
            self._free = address + size
            missing = self._free - self._memory.data_len(self._store)
            if missing > 0:
                self._memory.grow(self._store, -(-missing // PAGE))
            self._places[name] = address, size
        return address


def bits(array):
    """The patterns of numbers, with one pattern for every NaN."""
    array = np.where(np.isnan(array), np.nan, array)
    return array.view(np.uint8)


def inputs_of(system, function, dtype, count, seed=5):
    """Random inputs of a function by name, a row for each state, but for prepared constants."""
    states, rng = random_states(system, count, seed), np.random.default_rng(seed)
    inputs = {array.name: rng.standard_normal((count, *array.shape)) for array in function.inputs}
    inputs |= {"x": states.x, "y": states.y}
    for name in inputs.keys() & LOADS.keys():
        inputs[name][:, list(description(system).unloaded(LOADS[name]))] = 0.0
    return {
        array.name: inputs[array.name].astype(dtype) for array in function.inputs if array.name != "prepared"
    }


def native_results(native, function, inputs):
    """The results of a native function; the time is one number in a call, so such states go one by one."""
    call = getattr(native, function.name)
    if "t" not in inputs:
        return call(**inputs)
    rows = zip(*inputs.values(), strict=True)
    return np.array([call(**dict(zip(inputs, row, strict=True))) for row in rows])
