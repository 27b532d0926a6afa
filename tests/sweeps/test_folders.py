"""Folders of sweeps: the same bytes however they were made, nothing lost, and foreign folders refused."""

from __future__ import annotations

import errno
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest
import xarray

import kanegen as kg
from kanegen.sweeps import running
from kanegen.sweeps.chunk import Finished, Task
from kanegen.sweeps.running import Progress
from tests.support.paths import ROOT
from tests.support.sweeps import AXES, digests, job, pendulum, swept

FORMATS = ("parquet", pytest.param("zarr", marks=pytest.mark.slow))

SCRIPT = """
import sys
from tests.support.sweeps import swept
print("ready", flush=True)
swept(
    folder=sys.argv[1], format=sys.argv[2], chunk_rows=2, workers=2,
    progress=lambda done: print(done.rows, flush=True),
)
"""


@pytest.fixture(scope="module", params=FORMATS)
def complete(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of each format that one thread has filled, a chunk for each row."""
    folder = tmp_path_factory.mktemp("sweep") / request.param
    swept(folder=folder, format=request.param, chunk_rows=2, workers=1)
    return folder


def test_the_folder_has_what_memory_has(complete: Path) -> None:
    found, inner = kg.open_sweep(complete), swept()
    assert found.table.drop(columns="path.x.q1").equals(inner.table.drop(columns="path.x.q1"))
    np.testing.assert_array_equal(found.column("path.x.q1"), inner.column("path.x.q1"))
    shares = np.linspace(0, 1, 7)
    one, other = (result.bands("x.q1").quantiles(shares) for result in (found, inner))
    np.testing.assert_array_equal(one, other)
    assert found.reasons == inner.reasons
    assert found.folder == complete


def test_other_programs_read_the_table(tmp_path: Path) -> None:
    swept(folder=tmp_path / "p")
    table = pandas.read_parquet(tmp_path / "p" / "table")
    assert table["row"].tolist() == list(range(48))
    swept(folder=tmp_path / "z", format="zarr")
    data = xarray.open_zarr(tmp_path / "z" / "arrays.zarr", consolidated=False)
    np.testing.assert_array_equal(data["end.x.q1"].values.ravel(), table["end.x.q1"])
    assert data["end.x.q1"].attrs["units"] == "rad"


def test_any_number_of_workers_gives_the_same_bytes(complete: Path, tmp_path: Path) -> None:
    swept(folder=tmp_path, format=complete.name, chunk_rows=2, workers=3)
    assert digests(tmp_path) == digests(complete)


def started(folder: Path, store: str) -> subprocess.Popen[str]:
    """Begin the sweep in a process of its own, and return it when the first rows are finished."""
    process = subprocess.Popen(
        [sys.executable, "-c", SCRIPT, str(folder), store], cwd=ROOT, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    process.stdout.readline()
    process.stdout.readline()
    return process


def test_a_killed_sweep_goes_on(complete: Path, tmp_path: Path) -> None:
    process = started(tmp_path, complete.name)
    process.kill()
    process.communicate()
    kept = kg.open_sweep(tmp_path).store.finished()
    assert 0 < len(kept) < 24
    seen: list[Progress] = []
    found = swept(folder=tmp_path, format=complete.name, chunk_rows=2, progress=seen.append)
    assert seen[0].rows == 2 * len(kept)
    assert seen[-1].new == 48 - 2 * len(kept)
    assert found.is_complete
    assert digests(tmp_path) == digests(complete)


@pytest.mark.slow
def test_a_sweep_killed_twenty_times_at_random(complete: Path, tmp_path: Path) -> None:
    """Killed after random times, also while files are written; every row is there once, in the same bytes."""
    rng, before, kills = random.Random(0), 0, 0
    while kills < 20:
        process = started(tmp_path, complete.name) if before < 24 else None
        if process is None:  # all is finished: begin anew
            shutil.rmtree(tmp_path)
            before = 0
            continue
        time.sleep(rng.uniform(0, 0.05))
        kills += process.poll() is None
        process.kill()
        process.communicate()
        kept = len(kg.open_sweep(tmp_path).store.finished())
        assert kept >= before
        before = kept
    found = swept(folder=tmp_path, format=complete.name, chunk_rows=2)
    assert found.column("row").tolist() == list(range(48))
    assert digests(tmp_path) == digests(complete)


def test_an_interrupted_sweep_keeps_what_is_finished(complete: Path, tmp_path: Path) -> None:
    def interrupt(done: Progress) -> None:
        if done.new == 6:
            signal.raise_signal(signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        swept(folder=tmp_path, format=complete.name, chunk_rows=2, progress=interrupt)
    assert 6 <= kg.open_sweep(tmp_path).finished < 48
    swept(folder=tmp_path, format=complete.name, chunk_rows=2)
    assert digests(tmp_path) == digests(complete)


def test_a_damaged_part_is_computed_again(tmp_path: Path) -> None:
    swept(folder=tmp_path)
    expected = digests(tmp_path)
    parts = sorted((tmp_path / "table").iterdir())
    parts[1].write_bytes(parts[1].read_bytes()[:-9])
    parts[2].write_bytes(b"")
    shutil.copy(parts[0], parts[3])
    parts[4].unlink()
    (tmp_path / "table" / "notes.txt").write_text("mine")
    seen: list[Progress] = []
    swept(folder=tmp_path, progress=seen.append)
    assert seen[-1].new == 8 * 4
    (tmp_path / "table" / "notes.txt").unlink()
    assert digests(tmp_path) == expected


def flipped(file: Path, place: int) -> None:
    """Flip one bit of a file."""
    content = bytearray(file.read_bytes())
    content[place // 8] ^= 1 << place % 8
    file.write_bytes(content)


def test_one_flipped_bit_is_seen(complete: Path, tmp_path: Path) -> None:
    """A chunk with one is not finished, unless it is in Zarr, where a few bits have no effect on numbers."""
    ends = kg.open_sweep(complete).column("end.x.q1")
    shutil.copytree(complete, tmp_path, dirs_exist_ok=True)
    inner = "table" if complete.name == "parquet" else "arrays.zarr/end.x.q1/c"
    rng = random.Random(0)
    files = [path for path in sorted((tmp_path / inner).rglob("*")) if path.is_file()]
    for _ in range(60):
        file = rng.choice(files)
        before = file.read_bytes()
        flipped(file, rng.randrange(8 * len(before)))
        found = kg.open_sweep(tmp_path)
        if found.finished == 48:
            assert complete.name == "zarr"
            np.testing.assert_array_equal(found.column("end.x.q1"), ends)
        file.write_bytes(before)
    assert kg.open_sweep(tmp_path).is_complete
    flipped(files[3], 4 * files[3].stat().st_size)
    found = kg.open_sweep(tmp_path)
    assert len(found.table) == 46
    swept(folder=tmp_path, format=complete.name, chunk_rows=2)
    assert digests(tmp_path) == digests(complete)


def test_bytes_that_change_while_results_are_read(tmp_path: Path) -> None:
    found = swept(folder=tmp_path)
    assert found.is_complete
    file = tmp_path / "table" / "part-0000001.parquet"
    times = file.stat()
    flipped(file, 999)
    os.utime(file, ns=(times.st_atime_ns, times.st_mtime_ns))
    with pytest.raises(kg.ReadError, match=r"part-0000001.parquet: the file is damaged. Sweep again"):
        found.column("reason")


def test_bins_that_are_damaged_or_lost_are_computed_again(complete: Path, tmp_path: Path) -> None:
    shutil.copytree(complete, tmp_path, dirs_exist_ok=True)
    (file,) = (tmp_path / "bands").iterdir()
    flipped(file, 5000)
    with pytest.raises(kg.ReadError, match=r"the file is damaged. Sweep again to compute it anew"):
        kg.open_sweep(tmp_path).bands("x.q1")
    seen: list[Progress] = []
    swept(folder=tmp_path, format=complete.name, chunk_rows=2, progress=seen.append)
    assert (seen[0].rows, seen[0].failed, seen[-1].failed) == (0, 0, 16)
    assert digests(tmp_path) == digests(complete)
    file.unlink()
    with pytest.raises(kg.ReadError, match=r"bins of finished chunks are lost. Sweep again"):
        kg.open_sweep(tmp_path).bands("x.q1")
    swept(folder=tmp_path, format=complete.name, chunk_rows=2)
    assert digests(tmp_path) == digests(complete)


def test_a_sweep_that_was_killed_before_its_manifest_was_there(tmp_path: Path) -> None:
    (tmp_path / "table").mkdir()
    assert swept(folder=tmp_path).is_complete


def test_a_manifest_that_was_changed(tmp_path: Path) -> None:
    """Reading refuses it; sweeping again writes it anew, since it knows every entry."""
    swept(folder=tmp_path)
    expected, file = digests(tmp_path), tmp_path / "sweep.json"
    manifest = json.loads(file.read_text())
    without = {name: value for name, value in manifest.items() if name != "columns"}
    for changed in ({**manifest, "chunk_rows": 0}, {**manifest, "rows": float("nan")}, without):
        file.write_text(json.dumps(changed))
        with pytest.raises(kg.ReadError, match=r"sweep.json: it was changed or damaged. Sweep again"):
            kg.open_sweep(tmp_path)
        assert swept(folder=tmp_path).is_complete
        assert digests(tmp_path) == expected
    file.write_text("[" * 100_000)
    with pytest.raises(kg.ReadError, match="no file of a sweep of this version"):
        kg.open_sweep(tmp_path)


def test_nothing_is_left_over(complete: Path) -> None:
    names = {path.name for path in complete.iterdir()}
    assert names == {"sweep.json", "table", "bands", *(["arrays.zarr"] if complete.name == "zarr" else [])}
    assert len(list((complete / "bands").iterdir())) == 1


def test_the_manifest_says_what_the_sweep_is(complete: Path) -> None:
    manifest = json.loads((complete / "sweep.json").read_text())
    assert manifest["axes"]["x.q1"] == {"uniform": [-2.0, 2.0]}
    assert manifest["samples"] == {"count": 16, "method": "sobol", "seed": 0}
    assert manifest["job"]["results"] == ["end.x", "max.y.q2", "drift.energy", "path.x.q1"]
    assert manifest["columns"]["end.x.q1"] == {"kind": "result", "unit": "rad"}
    assert manifest["rows"] == 48
    assert str(ROOT) not in (complete / "sweep.json").read_text()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"job": job(0.8)}, "holds another sweep: its job.duration is 0.4, not 0.8. Choose another folder."),
        ({"samples": 32}, "holds another sweep: its rows is 48, not 96."),
        ({"axes": {**AXES, "m2": [0.5, 1.0, 2.0]}}, "its axes.m2 is [0.5, 1.0, -1.0], not [0.5, 1.0, 2.0]."),
        ({"system": pendulum().with_parameters({"l1": 2.0})}, "holds another sweep: its model differs."),
    ],
)
def test_another_sweep_is_refused(complete: Path, changes: dict[str, Any], message: str) -> None:
    asked: dict[str, Any] = {"system": pendulum(), "axes": AXES, "job": job(), "samples": 16, **changes}
    before = digests(complete)
    with pytest.raises(kg.WriteError) as caught:
        kg.sweep(**asked, folder=complete, format=complete.name, chunk_rows=2)
    assert message in str(caught.value)
    assert digests(complete) == before


def test_foreign_folders_are_refused(tmp_path: Path) -> None:
    (tmp_path / "thesis.txt").write_text("mine")
    with pytest.raises(kg.WriteError, match=r"holds 'thesis.txt' and is no folder of a sweep"):
        swept(folder=tmp_path)
    with pytest.raises(kg.ReadError, match=r"there is no sweep.json, so this is no folder of a sweep"):
        kg.open_sweep(tmp_path)
    for text in ("{", '{"format": "other"}'):
        (tmp_path / "sweep.json").write_text(text)
        with pytest.raises(kg.ReadError, match="no file of a sweep of this version"):
            swept(folder=tmp_path)
    with pytest.raises(kg.WriteError, match="cannot be made"):
        swept(folder=tmp_path / "thesis.txt")
    assert {path.name for path in tmp_path.iterdir()} == {"thesis.txt", "sweep.json"}


def test_one_process_writes_at_a_time(tmp_path: Path) -> None:
    def meanwhile(done: Progress) -> None:
        if done.new == 8:
            with pytest.raises(kg.WriteError, match="another process runs this sweep"):
                swept(folder=tmp_path)
            assert kg.open_sweep(tmp_path).finished == 8

    assert swept(folder=tmp_path, progress=meanwhile).is_complete


@pytest.fixture
def full_disk(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A disk on which no more than three new files have room."""
    replace, room = os.replace, iter(range(3))

    def limited(source: Any, target: Any) -> None:
        if "part-" in str(target) and next(room, None) is None:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        replace(source, target)

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", limited)
        yield


def test_a_full_disk_keeps_finished_chunks(tmp_path: Path, request: pytest.FixtureRequest) -> None:
    request.getfixturevalue("full_disk")
    with pytest.raises(kg.WriteError) as caught:
        swept(folder=tmp_path, workers=1)
    message = str(caught.value)
    assert message.endswith(
        "cannot be written: No space left on device. Finished chunks are kept; sweep again to go on."
    )
    assert len(kg.open_sweep(tmp_path).store.finished()) == 3


def test_a_worker_that_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    compute = running.compute

    def failing(task: Task) -> Finished:
        if task.number == 2:
            raise MemoryError("no room")
        return compute(task)

    monkeypatch.setattr(running, "compute", failing)
    with pytest.raises(kg.SweepError, match=r"^chunk 2: MemoryError: no room\. Finished chunks are kept"):
        swept(folder=tmp_path, workers=1)
    monkeypatch.undo()
    assert swept(folder=tmp_path).is_complete
