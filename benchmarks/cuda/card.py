"""Run the prepared kernels on a card: bits beside those of the C, and states a second.

python card.py [FOLDER]

It needs Python and the driver of the card, nothing else: no compiler, no package, no network.
"""

from __future__ import annotations

import ctypes
import json
import statistics
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

COUNTS = (1 << 10, 1 << 14, 1 << 18, 1 << 22)
"""Numbers of states of a launch."""

ROUNDS = 7
"""Rounds of which the median counts."""

LEAST_MS = 20.0
"""Milliseconds that a round takes at least."""

PUBLISHED = (
    "GRiD (Plancher, Neuman, Ghosal, Kuindersma, Reddi, ICRA 2022), RTX 3080, single precision, one call: "
    "forward dynamics 7.7 us (IIWA, 7 freedoms), 6.9 us (HyQ), 22.4 us (Atlas)"
)
"""What others published; a call is one launch, not one state of a batch."""


class Card:
    """The first card of the machine, by CUDA's driver interface.

    Raises:
        RuntimeError: If there is no driver or no card, or a call of the driver fails.
    """

    def __init__(self) -> None:
        try:
            self._driver = ctypes.CDLL("libcuda.so.1")
        except OSError as error:
            raise RuntimeError(f"no card: this machine has no driver of NVIDIA ({error})") from None
        if self._driver.cuInit(0) != 0:
            raise RuntimeError("no card: the driver of NVIDIA finds none")
        device, context = ctypes.c_int(), ctypes.c_void_p()
        self._call("cuDeviceGet", ctypes.byref(device), 0)
        self._device = device
        self._call("cuDevicePrimaryCtxRetain", ctypes.byref(context), device)
        self._call("cuCtxSetCurrent", context)
        name = ctypes.create_string_buffer(100)
        self._call("cuDeviceGetName", name, 100, device)
        self.name = name.value.decode()
        self.capability = self._attribute(75), self._attribute(76)

    def _call(self, name: str, *arguments: Any) -> None:
        result = getattr(self._driver, name)(*arguments)
        if result:
            text = ctypes.c_char_p()
            self._driver.cuGetErrorString(result, ctypes.byref(text))
            raise RuntimeError(f"{name}: {(text.value or b'').decode() or result}")

    def _attribute(self, number: int) -> int:
        value = ctypes.c_int()
        self._call("cuDeviceGetAttribute", ctypes.byref(value), number, self._device)
        return value.value

    def kernel(self, binary: bytes, name: str) -> ctypes.c_void_p:
        """Return a kernel of a compiled program."""
        loaded, function = ctypes.c_void_p(), ctypes.c_void_p()
        self._call("cuModuleLoadData", ctypes.byref(loaded), binary)
        self._call("cuModuleGetFunction", ctypes.byref(function), loaded, name.encode())
        return function

    def memory(self, size: int) -> ctypes.c_uint64:
        """Return the address of `size` bytes of the card."""
        address = ctypes.c_uint64()
        self._call("cuMemAlloc_v2", ctypes.byref(address), ctypes.c_size_t(size))
        return address

    def free(self, *addresses: ctypes.c_uint64) -> None:
        """Give memory back."""
        for address in addresses:
            self._call("cuMemFree_v2", address)

    def write(self, address: ctypes.c_uint64, data: bytes) -> None:
        """Copy bytes to the card."""
        self._call("cuMemcpyHtoD_v2", address, data, ctypes.c_size_t(len(data)))

    def read(self, address: ctypes.c_uint64, size: int) -> bytes:
        """Copy bytes from the card, after all that runs there."""
        data = ctypes.create_string_buffer(size)
        self._call("cuMemcpyDtoH_v2", data, address, ctypes.c_size_t(size))
        return data.raw

    def launch(self, kernel: ctypes.c_void_p, blocks: int, threads: int, arguments: Sequence[Any]) -> None:
        """Start a kernel."""
        pointers = (ctypes.c_void_p * len(arguments))(*(ctypes.addressof(one) for one in arguments))
        sizes = [ctypes.c_uint(one) for one in (blocks, 1, 1, threads, 1, 1, 0)]
        self._call("cuLaunchKernel", kernel, *sizes, None, pointers, None)

    def milliseconds(self, work: Any) -> float:
        """Return how long the card needs for what `work` starts."""
        events = [ctypes.c_void_p(), ctypes.c_void_p()]
        for event in events:
            self._call("cuEventCreate", ctypes.byref(event), 0)
        self._call("cuEventRecord", events[0], None)
        work()
        self._call("cuEventRecord", events[1], None)
        self._call("cuEventSynchronize", events[1])
        elapsed = ctypes.c_float()
        self._call("cuEventElapsedTime", ctypes.byref(elapsed), *events)
        for event in events:
            self._call("cuEventDestroy_v2", event)
        return elapsed.value


def binary(folder: Path, case: str, card: Card, contraction: str) -> bytes:
    """Return the compiled kernel for a card; assembly where none was compiled for it."""
    architecture = {8: "sm_80", 9: "sm_90"}.get(card.capability[0], "compute_80")
    return (folder / f"{case}_{architecture}_{contraction}.bin").read_bytes()


class Batch:
    """The arrays of a launch on a card: the prepared states, repeated up to a number of states."""

    def __init__(self, card: Card, case: dict[str, Any], columns: list[list[bytes]], count: int) -> None:
        known = len(columns[0][0]) // case["bytes"]
        self.count, self._card = count, card
        self._arrays = []
        for rows in columns:
            data = b"".join((row * (-(-count // known)))[: count * case["bytes"]] for row in rows)
            self._arrays.append(card.memory(len(data)))
            card.write(self._arrays[-1], data)
        self.results = card.memory(case["results"] * count * case["bytes"])
        self._status = card.memory(4 * count)
        self._case = case
        self._size = case["results"] * count * case["bytes"]

    def launch(self, kernel: ctypes.c_void_p) -> None:
        """Start a kernel for all states."""
        count = ctypes.c_size_t(self.count)
        blocks = min(-(-self.count // self._case["block_states"]), 1 << 20)
        arguments = [count, count, *self._arrays, self.results, self._status]
        self._card.launch(kernel, blocks, self._case["block"], arguments)

    def read(self) -> bytes:
        """Return the results, element by element."""
        return self._card.read(self.results, self._size)

    def free(self) -> None:
        """Give the memory back."""
        self._card.free(*self._arrays, self.results, self._status)


def columns_of(folder: Path, case: dict[str, Any], states: int) -> tuple[list[list[bytes]], bytes]:
    """Return the elements of all inputs, each for all states, and the results of the C."""
    data = (folder / f"{case['name']}_states.bin").read_bytes()
    length, place = states * case["bytes"], 0
    columns = []
    for size in case["sizes"]:
        starts = range(place, place + size * length, length)
        columns.append([data[start : start + length] for start in starts])
        place += size * length
    return columns, data[place:]


def measure(folder: Path, card: Card, case: dict[str, Any], states: int) -> bool:
    """Print bits and speed of a case; return whether the bits are those of the C."""
    columns, expected = columns_of(folder, case, states)
    kernel = card.kernel(binary(folder, case["name"], card, "false"), case["kernel"])
    batch = Batch(card, case, columns, states)
    batch.launch(kernel)
    same = batch.read() == expected
    batch.free()
    print(f"{case['name']}: {'bits of the C' if same else 'BITS DIFFER FROM THE C'} in {states} states")
    for contraction in ("false", "true"):
        kernel = card.kernel(binary(folder, case["name"], card, contraction), case["kernel"])
        for count in COUNTS:
            low, median, high = speeds(card, case, columns, kernel, count)
            print(
                f"    --fmad={contraction}, {count} states: {median:.3g} states/s "
                f"({low:.3g} to {high:.3g}), {1e6 * count / median:.1f} us a launch",
                flush=True,
            )
    return same


def speeds(
    card: Card, case: dict[str, Any], columns: list[list[bytes]], kernel: ctypes.c_void_p, count: int
) -> tuple[float, float, float]:
    """Return least, median and most states a second of several rounds."""
    batch = Batch(card, case, columns, count)
    once = max(card.milliseconds(lambda: batch.launch(kernel)), 1e-3)
    repeats = max(1, min(2000, int(LEAST_MS / once)))

    def work() -> None:
        for _ in range(repeats):
            batch.launch(kernel)

    found = sorted(1e3 * count * repeats / card.milliseconds(work) for _ in range(ROUNDS))
    batch.free()
    return found[0], statistics.median(found), found[-1]


def main() -> int:
    """Measure all cases on the first card.

    Returns:
        0, 1 where bits differ, and 2 without a card.
    """
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).parent
    try:
        card = Card()
    except RuntimeError as error:
        print(f"{error}. Nothing was measured.")
        return 2
    described = json.loads((folder / "cases.json").read_text())
    print(f"{card.name}, compute capability {card.capability[0]}.{card.capability[1]}")
    same = [measure(folder, card, case, described["states"]) for case in described["cases"]]
    print(f"published: {PUBLISHED}")
    return 0 if all(same) else 1


if __name__ == "__main__":
    sys.exit(main())
