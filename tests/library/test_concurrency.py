"""Processes that build at once, damage and clear the cache, and are killed at any moment: no wrong result.

Entries are removed at any moment, and damaged at any moment but between the check of a file and its use.
"""

from __future__ import annotations

import hashlib
import itertools
import os
import random
import signal
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np
import pytest

from kanegen.errors import KanegenError
from kanegen.library import load
from kanegen.library.native import cache
from tests.support.handmade import bits, evaluate, module, source

fcntl = pytest.importorskip("fcntl")

RIGHT, BUILT, WRONG, FAILED = "right", "built", "wrong", "failed"

Step = Callable[[random.Random], str]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "cache"


def run(step: Step, workers: int, kills: int, builds: int, longest: float, log: Path) -> Counter[str]:
    """Let processes repeat a step, each until it is killed after a random time, and count the outcomes.

    Args:
        step: Returns the outcome, one word.
        workers: Number of processes at the same time.
        kills: Number of processes that are killed at least.
        builds: Number of outcomes `BUILT` that there have to be; a busy machine takes longer.
        longest: Longest life of a process, s.
        log: File of the outcomes.
    """
    rng = random.Random(13)
    begun: dict[int, float] = {}
    log.touch()
    for number in itertools.count():
        outcomes = Counter(log.read_text().split())
        has_failed = outcomes[WRONG] or outcomes[FAILED]
        if number >= kills + workers and (outcomes[BUILT] >= builds or has_failed):
            break
        if len(begun) == workers:
            process = min(begun, key=lambda process: begun[process])
            time.sleep(max(begun.pop(process) - time.monotonic(), 0.0))
            os.kill(process, signal.SIGKILL)
            os.waitpid(process, 0)
        process = os.fork()
        if process == 0:
            repeat(step, random.Random(number), log)
        begun[process] = time.monotonic() + rng.uniform(0.0, longest)
    for process in begun:
        os.kill(process, signal.SIGKILL)
        os.waitpid(process, 0)
    return Counter(log.read_text().split())


def repeat(step: Step, rng: random.Random, log: Path) -> None:
    """Repeat a step for ever, and append a word to the log for each outcome; never return."""
    with log.open("ab", buffering=0) as file:
        while True:
            try:
                outcome = step(rng)
            except BaseException as error:
                outcome = f"{FAILED} {type(error).__name__}-{'-'.join(str(error).split())}"
            file.write(f"{outcome}\n".encode())


@contextmanager
def locked(kind: int) -> Iterator[None]:
    """Hold a lock that those who use entries share, and those who damage them have alone."""
    with (cache.folder().parent / "damaging").open("w") as file:
        fcntl.flock(file, kind)
        yield


def harm(rng: random.Random) -> None:
    """Now and then damage or remove a file of an entry, or clear the cache."""
    chance = rng.random()
    if chance < 0.05:
        cache.clear()
    elif chance < 0.2 and (entries := cache.entries()):
        with locked(fcntl.LOCK_EX), suppress(OSError):  # another process may have removed it
            path = rng.choice(sorted(rng.choice(entries).path.iterdir()))
            half = path.read_bytes()[: rng.randrange(200)]
            path.unlink()
            if rng.random() < 0.7:
                path.write_bytes(half)


def use_an_entry(rng: random.Random) -> str:
    """Use one of a few entries, whose content is known; filling it takes a few ms."""
    harm(rng)
    number = rng.randrange(6)
    built = []

    def fill(path: Path) -> None:
        built.append(path)
        for part in range(4):
            (path / f"part{part}").write_text(f"{number} {part} " * 500)
            time.sleep(rng.uniform(0.0, 0.004))

    def take(path: Path) -> str:
        return hashlib.sha256(b"".join((path.parent / f"part{k}").read_bytes() for k in range(4))).hexdigest()

    with locked(fcntl.LOCK_SH):
        found = cache.use(cache.key([str(number)]), "part3", fill, take)
    expected = hashlib.sha256("".join(f"{number} {part} " * 500 for part in range(4)).encode()).hexdigest()
    return (BUILT if built else RIGHT) if found == expected else WRONG


def require_clean(outcomes: Counter[str], folder: Path) -> None:
    """No outcome is wrong or an error, and the next build leaves nothing of the killed ones."""
    assert set(outcomes) <= {RIGHT, BUILT}, outcomes
    cache.clear()
    load(source())
    assert not [path for path in folder.iterdir() if path.name.startswith(".")]


def test_killed_and_concurrent_processes_never_see_a_wrong_entry(folder: Path, tmp_path: Path) -> None:
    outcomes = run(use_an_entry, workers=4, kills=60, builds=50, longest=0.3, log=tmp_path / "log")
    require_clean(outcomes, folder)
    assert outcomes[RIGHT] > 0


X, Y = [0.1, 0.2], [0.3, 0.4]
VARIANTS = [(parameters, loads) for parameters in (True, False) for loads in (True, False)]


@pytest.mark.slow
def test_concurrent_builds_give_right_results(folder: Path, tmp_path: Path) -> None:
    outcomes = run(compile_a_library(), workers=3, kills=8, builds=5, longest=1.5, log=tmp_path / "log")
    require_clean(outcomes, folder)


def compile_a_library() -> Step:
    """Return a step that builds one of 16 libraries and compares a result with that of the evaluator."""
    sources = [source(name, parameters=p, loads=q) for name in ("one", "two") for p, q in VARIANTS]
    expected = [expectation(*variant) for _ in range(2) for variant in VARIANTS]

    def step(rng: random.Random) -> str:
        harm(rng)
        number = rng.randrange(len(sources))
        before = {entry.path for entry in cache.entries()}
        with locked(fcntl.LOCK_SH):
            library = load(sources[number], flags=["-O0", rng.choice(["-fno-inline", "-finline"])])
        built = library.path.parent not in before
        if bits(library.forcing(X, Y)) != expected[number]:
            return WRONG
        return BUILT if built else RIGHT

    return step


def expectation(parameters: bool, loads: bool) -> list[str]:
    """Return the bits of {f} from the evaluator, which is no code of kanegen's."""
    programs = module(parameters=parameters, loads=loads)
    inputs = {"x": X, "y": Y, "force": np.zeros((3, 3)), "torque": np.zeros((3, 3))}
    if programs.prepare is not None:
        inputs["prepared"] = evaluate(programs.prepare, parameters=[2.0, 0.75])["prepared"]
    return bits(evaluate(programs.functions["forcing"], **inputs)["f"])


@pytest.mark.slow
def test_a_thousand_kills_and_hundreds_of_builds(
    folder: Path, tmp_path: Path, record_property: Callable[[str, object], None]
) -> None:
    """The figures of docs/reliability.md; entries are used and libraries compiled."""
    entries = run(use_an_entry, workers=6, kills=700, builds=500, longest=0.4, log=tmp_path / "entries")
    require_clean(entries, folder)
    builds = run(compile_a_library(), workers=4, kills=320, builds=500, longest=4.0, log=tmp_path / "builds")
    require_clean(builds, folder)
    print(f"\n1020 kills at least; entries {dict(entries)}; libraries {dict(builds)}")
    record_property("entries", dict(entries))
    record_property("libraries", dict(builds))


def test_an_error_is_an_outcome(tmp_path: Path) -> None:
    """The counting itself sees errors and wrong results."""

    def fails(rng: random.Random) -> str:
        time.sleep(0.001)
        if rng.random() < 0.5:
            raise KanegenError("no good")
        return WRONG

    outcomes = run(fails, workers=1, kills=2, builds=0, longest=0.1, log=tmp_path / "log")
    assert outcomes[WRONG]
    assert outcomes[FAILED] == outcomes["KanegenError-no-good"] > 0
