"""Files appear together and whole, or not at all, whatever stands in their place and whoever is killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from kanegen import files
from kanegen.errors import WriteError
from kanegen.files import PREFIX, require_writable, temporary_folder, write_all, write_whole
from tests.support.handmade import source
from tests.support.paths import ROOT
from tests.support.systems import chain


def contents(folder: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in folder.iterdir()}


def test_several_files_in_several_folders(tmp_path: Path) -> None:
    (tmp_path / "other").mkdir()
    (tmp_path / "a").write_text("old")
    write_all({tmp_path / "a": "1", tmp_path / "b": "2", tmp_path / "other" / "a": "3\n"})
    write_all({})
    assert (tmp_path / "other" / "a").read_bytes() == b"3\n"
    assert {path.name for path in tmp_path.iterdir()} == {"a", "b", "other"}
    assert (tmp_path / "a").read_text() + (tmp_path / "b").read_text() == "12"


def test_a_link_is_followed_and_permissions_stay(tmp_path: Path) -> None:
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "file").write_text("old")
    (tmp_path / "far" / "file").chmod(0o640)
    (tmp_path / "link").symlink_to("far/file")
    write_whole(tmp_path / "link", "new")
    assert (tmp_path / "link").is_symlink()
    assert contents(tmp_path / "far") == {"file": "new"}
    assert (tmp_path / "far" / "file").stat().st_mode & 0o777 == 0o640


@pytest.mark.parametrize(
    ("kind", "message"),
    [
        ("folder", "Is a directory"),
        ("link to a folder", "Is a directory"),
        ("dangling link", "it is a link to .*nowhere, which does not exist"),
        ("pipe", "it is a device or a pipe, not a file"),
        ("below a file", "Not a directory"),
        ("in no folder", "No such file or directory"),
        ("nul\0byte", "embedded null byte"),
        ("n" * 300, "File name too long"),
    ],
)
def test_what_cannot_be_written_is_found_before_anything_is(tmp_path: Path, kind: str, message: str) -> None:
    (tmp_path / "first").write_text("old")
    last = tmp_path / "last"
    if kind == "folder":
        last.mkdir()
    elif kind == "link to a folder":
        last.symlink_to(tmp_path)
    elif kind == "dangling link":
        last.symlink_to(tmp_path / "nowhere")
    elif kind == "pipe":
        os.mkfifo(last)
    elif kind == "below a file":
        last = tmp_path / "first" / "last"
    elif kind == "in no folder":
        last = tmp_path / "none" / "last"
    else:
        last = tmp_path / kind
    before = {path.name for path in tmp_path.iterdir()}
    for attempt in (
        lambda: write_all({tmp_path / "first": "new", last: "new"}),
        lambda: require_writable(tmp_path / "first", None, last),
    ):
        with pytest.raises(WriteError, match=f"cannot be written: {message}"):
            attempt()
    assert {path.name for path in tmp_path.iterdir()} == before
    assert (tmp_path / "first").read_text() == "old"


@pytest.mark.parametrize("has_links", [True, False])
@pytest.mark.parametrize("error", [OSError(5, "Input/output error"), KeyboardInterrupt()])
def test_a_rename_that_fails_undoes_those_before_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: BaseException, has_links: bool
) -> None:
    for name in "ad":
        (tmp_path / name).write_text(f"old {name}")
    replace = os.replace

    def failing(source: Path, target: Path) -> None:
        if target.name == "c" and source.suffix == ".new":
            raise error
        replace(source, target)

    def no_links(*_: object) -> None:
        raise OSError(1, "Operation not permitted")

    monkeypatch.setattr(os, "replace", failing)
    if not has_links:
        monkeypatch.setattr(os, "link", no_links)
    with pytest.raises((WriteError, KeyboardInterrupt)):
        write_all({tmp_path / name: "new" for name in "abcd"})
    assert contents(tmp_path) == {"a": "old a", "d": "old d"}


def test_a_temporary_folder_of_a_killed_process_is_removed_and_no_other(tmp_path: Path) -> None:
    code = (
        "import sys, time; from pathlib import Path; from kanegen.files import temporary_folder\n"
        "with temporary_folder(Path(sys.argv[1])) as folder:\n"
        "    (folder / 'half').touch(); print(folder, flush=True); time.sleep(60)"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code, str(tmp_path)],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
    )
    assert process.stdout is not None
    left = Path(process.stdout.readline().strip())
    write_whole(tmp_path / "a", "1")
    assert (left / "half").exists()
    process.kill()
    process.communicate()
    write_whole(tmp_path / "a", "2")
    assert contents(tmp_path) == {"a": "2"}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_process_that_was_forked_during_a_write_holds_no_lock(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace = files._replace
    children = []

    def forking(*arguments: Any) -> None:
        child = os.fork()
        if child == 0:
            time.sleep(60)
            os._exit(0)
        children.append(child)
        replace(*arguments)

    with monkeypatch.context() as patch:
        patch.setattr(files, "_replace", forking)
        patch.setattr(files.shutil, "rmtree", lambda *_, **__: None)  # as if the process were killed
        write_whole(tmp_path / "a", "1")
    begun = time.monotonic()
    write_whole(tmp_path / "a", "2")
    assert time.monotonic() - begun < 20.0  # a lock would be waited for 30 s
    os.kill(children[0], signal.SIGKILL)
    os.waitpid(children[0], 0)
    assert contents(tmp_path) == {"a": "2"}


def test_without_locks_a_temporary_folder_is_removed_after_a_day(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(files, "_locked", lambda folder: files._NOT_LOCKED)
    with temporary_folder(tmp_path) as own:
        for name, age in (("old", 90_000.0), ("young", 80_000.0)):
            folder = tmp_path / f"{PREFIX}{name}"
            folder.mkdir()
            os.utime(folder, times=(time.time() - age,) * 2)
        write_whole(tmp_path / "a", "1")
        assert {path.name for path in tmp_path.iterdir()} == {"a", f"{PREFIX}young", own.name}


WRITER = """
import sys
from pathlib import Path
from kanegen.files import write_all
folder = Path(sys.argv[1])
print("begun", flush=True)
for number in range(10_000_000):
    write_all({folder / name: f"{sys.argv[2]} {number} {'x' * 20_000}\\n" for name in "abc"})
"""


@pytest.fixture
def start(tmp_path: Path) -> Iterator[Callable[[str], subprocess.Popen[str]]]:
    """Return a function that starts a process which writes three files again and again."""
    processes: list[subprocess.Popen[str]] = []

    def begin(label: str) -> subprocess.Popen[str]:
        process = subprocess.Popen(
            [sys.executable, "-c", WRITER, str(tmp_path), label],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
        )
        processes.append(process)
        assert process.stdout is not None
        process.stdout.readline()
        return process

    yield begin
    for process in processes:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()


def test_killed_and_concurrent_writers_leave_whole_files(
    tmp_path: Path, start: Callable[[str], subprocess.Popen[str]]
) -> None:
    """Two processes write the same files; one after the other is killed, and files are whole at any time."""
    for turn in range(6):
        process = start(f"writer {turn}")
        until = time.monotonic() + 0.05 + 0.02 * turn
        while time.monotonic() < until:
            for path in tmp_path.glob("[abc]"):
                text = path.read_text()
                assert text.startswith("writer ")
                assert text.endswith("x\n")
                assert text.count("x") == 20_000
        if turn % 2:
            process.kill()


def test_writers_of_the_same_files_take_turns(
    tmp_path: Path, start: Callable[[str], subprocess.Popen[str]]
) -> None:
    """While no process renames, all three files are of the same writer and the same round."""
    for label in ("one", "two"):
        start(label)
    write_all(dict.fromkeys((tmp_path / name for name in "abc"), "begin"))
    seen = set()
    for _ in range(60):
        with files._one_writer_at_a_time([tmp_path]):
            texts = {(tmp_path / name).read_text() for name in "abc"}
        assert len(texts) == 1
        seen |= {text.partition("x")[0] for text in texts}
        time.sleep(0.01)
    assert len(seen) > 1


def test_after_all_writers_are_killed_one_write_cleans_up(
    tmp_path: Path, start: Callable[[str], subprocess.Popen[str]]
) -> None:
    for turn in range(3):
        process = start(f"writer {turn}")
        time.sleep(0.05)
        process.kill()
        process.wait()
    write_all({tmp_path / name: "end" for name in "abc"})
    assert contents(tmp_path) == dict.fromkeys("abc", "end")


@pytest.mark.parametrize("path", [None, 5, b"bytes.toml", ["a"], object()])
def test_what_is_no_path(path: Any) -> None:
    for attempt in (source().write, chain(1).save):
        with pytest.raises(WriteError, match="is not the path of a file or folder") as caught:
            attempt(path)
        assert "\n" not in str(caught.value)
