"""The cache of compiled code: who may write it, damage, limits, and what processes do to each other in it."""

import hashlib
import os
import pickle
import stat
import subprocess
import sys
import time
from pathlib import Path

import pytest

from kanegen.errors import BuildError
from kanegen.files import temporary_folder
from kanegen.library import load
from kanegen.library.native import cache, ownership, processor
from kanegen.library.native.build import build
from tests.support.handmade import bits, source
from tests.support.paths import ROOT


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Return the cache folder, which is not there yet."""
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "cache"


def make(name, text="content", file="file", take=Path.read_text):
    """Return what `take` returns for an entry, and how often it was filled."""
    filled = []

    def fill(path):
        filled.append(path)
        (path / file).write_text(text)
        (path / "source.c").write_text("int x;")

    return cache.use(cache.key([name]), file, fill, take), len(filled)


def age(name, seconds):
    """Let an entry look as if it had not been used for a time."""
    path = cache.folder() / cache.key([name]) / "SHA256SUMS"
    os.utime(path, times=(time.time() - seconds,) * 2)


# Who may write it


def test_the_folder_and_those_above_are_made_for_the_user_alone(monkeypatch, tmp_path):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "a" / "b"))
    before = os.umask(0)
    try:
        make("one")
    finally:
        os.umask(before)
    modes = {stat.S_IMODE((tmp_path / path).stat().st_mode) for path in ("a", "a/b")}
    assert modes == {0o700}
    (entry,) = cache.entries()
    assert not any(path.stat().st_mode & 0o022 for path in (entry.path, *entry.path.iterdir()))


def refused(match):
    with pytest.raises(BuildError, match=match) as caught:
        make("one")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("mode", [0o777, 0o757, 0o1777])
def test_a_folder_that_others_can_write_is_refused(folder, mode):
    make("one")
    folder.chmod(mode)
    refused(
        rf"cache folder .* is not safe .*others can write {folder}, mode {mode:04o}: `chmod go-w` it, or set"
    )
    assert cache.find(cache.key(["one"]), "file") is None
    with pytest.raises(BuildError, match="is not safe"):
        cache.clear()
    folder.chmod(0o755)
    assert make("one") == ("content", 0)


def test_a_folder_that_a_group_can_write_is_refused_unless_it_is_the_users_own(folder, monkeypatch):
    folder.mkdir()
    folder.chmod(0o775)
    monkeypatch.setattr(ownership, "_is_own_group", lambda number: False)
    refused("others can write .*mode 0775")
    monkeypatch.setattr(ownership, "_is_own_group", lambda number: True)
    make("one")


def test_own_groups(monkeypatch):
    """The group of a user who is alone in it, as many systems make it, is no group of others."""
    grp, pwd = pytest.importorskip("grp"), pytest.importorskip("pwd")
    me = pwd.getpwuid(os.getuid()).pw_name
    for name, members, own in ((me, [], True), (me, [me], True), (me, ["eve"], False), ("staff", [], False)):
        group = grp.struct_group((name, "x", 4711, members))
        monkeypatch.setattr(grp, "getgrgid", lambda number, group=group: group)
        assert ownership._is_own_group(4711) is own


def test_a_folder_of_another_user_is_refused(folder, monkeypatch):
    folder.mkdir()
    monkeypatch.setattr(ownership, "_administrators", lambda: {os.getuid() + 1})
    refused(rf"{folder} belongs to user {os.getuid()}")


def test_a_folder_below_one_that_others_can_write_is_refused(tmp_path, monkeypatch):
    above = tmp_path / "above"
    above.mkdir()
    above.chmod(0o777)
    monkeypatch.setenv(cache.VARIABLE, str(above / "a" / "cache"))
    refused(rf"others can write {above}, mode 0777")
    above.chmod(0o1777)  # with the sticky bit nobody else can rename what is in it
    make("one")


def test_a_link_counts_as_the_folder_to_which_it_leads(tmp_path, folder):
    open_to_all, own = tmp_path / "open", tmp_path / "own"
    for path in (open_to_all, own):
        path.mkdir()
    open_to_all.chmod(0o777)
    folder.symlink_to(open_to_all)
    refused("others can write .*open")
    folder.unlink()
    folder.symlink_to(own)
    assert make("one") == ("content", 1)
    assert [path.name for path in own.iterdir()] == [cache.key(["one"])]
    folder.unlink()
    folder.symlink_to(tmp_path / "nowhere")
    refused("cannot be used: ")


def test_an_entry_that_others_can_write_is_made_anew():
    make("one")
    (entry,) = cache.entries()
    entry.path.chmod(0o777)
    assert make("one") == ("content", 1)
    (entry,) = cache.entries()
    assert stat.S_IMODE(entry.path.stat().st_mode) == 0o700
    (entry.path / "file").chmod(0o666)
    assert make("one") == ("content", 1)


@pytest.mark.parametrize("home", ["~/cache", "~/deep/er"])
def test_a_tilde_is_the_home_folder(monkeypatch, tmp_path, home):
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    monkeypatch.setenv(cache.VARIABLE, home)
    monkeypatch.chdir(tmp_path)
    make("one")
    assert cache.folder() == tmp_path / "home" / home[2:]
    assert [path.name for path in tmp_path.iterdir()] == ["home"]


def test_the_home_folder_of_nobody(monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, "~no-such-user/cache")
    refused(r"\$KANEGEN_CACHE: '~no-such-user/cache' is no folder")


@pytest.mark.parametrize("name", ["x" * 300, "file/cache"])
def test_a_folder_that_cannot_be(monkeypatch, tmp_path, name):
    (tmp_path / "file").touch()
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / name))
    refused("cannot be used: ")
    if name != "file/cache":
        with pytest.raises(BuildError, match="cannot be used: File name too long"):
            cache.entries()


# Damage


def truncated(path):
    beginning = path.read_bytes()[:3]
    path.unlink()  # this process may have mapped the pages of the old file
    path.write_bytes(beginning)


def without_its_line(path):
    digests = path.parent / "SHA256SUMS"
    lines = digests.read_text().splitlines(keepends=True)
    digests.write_text("".join(line for line in lines if not line.endswith(f"  {path.name}\n")))


def without_line_and_file(path):
    without_its_line(path)
    path.unlink()


def replaced_by_a_link(path):
    path.rename(path.parents[2] / "elsewhere")
    path.symlink_to(path.parents[2] / "elsewhere")


def replaced_by_a_pipe(path):
    """Reading it would wait for ever."""
    path.unlink()
    os.mkfifo(path)


def replaced_by_a_folder(path):
    path.unlink()
    path.mkdir()


def with_a_pipe_for_its_digests(path):
    replaced_by_a_pipe(path.parent / "SHA256SUMS")


def beside_another_file(path):
    (path.parent / "more").touch()


def listing_a_file_outside(path):
    outside = path.parents[2] / "outside"
    outside.write_text("x")
    with (path.parent / "SHA256SUMS").open("a") as digests:
        digests.write(f"{hashlib.sha256(b'x').hexdigest()}  ../../outside\n")


HARMS = [
    *(truncated, Path.unlink, without_its_line, without_line_and_file, replaced_by_a_link),
    *(replaced_by_a_pipe, replaced_by_a_folder, with_a_pipe_for_its_digests),
    *(beside_another_file, listing_a_file_outside),
]


@pytest.mark.parametrize("harm", HARMS)
def test_a_damaged_entry_is_never_used_and_made_anew(harm):
    make("one")
    (entry,) = cache.entries()
    harm(entry.path / "file")
    assert cache.find(entry.path.name, "file") is None
    assert make("one") == ("content", 1)
    assert make("one") == ("content", 0)


def test_a_list_of_digests_that_is_no_text():
    make("one")
    (entry,) = cache.entries()
    (entry.path / "SHA256SUMS").write_bytes(b"\xff\0\n")
    assert make("one") == ("content", 1)


def test_an_error_of_whoever_takes_a_sound_file_is_passed_on():
    def take(path):
        raise BuildError("cannot be loaded")

    with pytest.raises(BuildError, match="cannot be loaded"):
        make("one", take=take)
    assert len(cache.entries()) == 1


def test_an_entry_that_is_removed_before_it_is_used_is_made_again():
    taken = []

    def take(path):
        taken.append(path)
        if len(taken) < 3:
            cache.clear()
        return path.read_text()

    assert make("one", take=take) == ("content", 3)


STATE = ([0.1, 0.2], [0.3, 0.4])


@pytest.mark.parametrize("harm", [truncated, without_its_line, lambda path: cache.clear()])
def test_a_pickled_library_whose_file_is_damaged_is_made_from_its_source(harm):
    library = load(source(), flags="-O0")
    heavy, expected = library.with_parameters({"m1": 3.0}), bits(library.forcing(*STATE))
    data = [pickle.dumps(library), pickle.dumps(heavy)]
    harm(library.path)
    again, other = map(pickle.loads, data)
    assert bits(again.forcing(*STATE)) == bits(library.forcing(*STATE)) == expected
    assert other.parameters == {"m1": 3.0, "sin": 0.75}
    assert bits(other.forcing(*STATE)) == bits(heavy.forcing(*STATE))
    assert again.path == library.path
    assert library.path.stat().st_size > 1000


def test_a_pickled_library_needs_no_compiler_where_its_file_is_there(monkeypatch):
    library = load(source())
    data = pickle.dumps(library)
    monkeypatch.setenv("KANEGEN_CC", "no-such-cc")
    assert bits(pickle.loads(data).forcing(*STATE)) == bits(library.forcing(*STATE))
    cache.clear()
    with pytest.raises(BuildError, match="no-such-cc"):
        pickle.loads(data)


def test_a_pickled_library_is_not_loaded_on_another_processor(monkeypatch):
    library = load(source())
    data = pickle.dumps(library)
    monkeypatch.setattr(processor, "fingerprint", lambda: "another processor")
    again = pickle.loads(data)
    assert again.path != library.path
    assert bits(again.forcing(*STATE)) == bits(library.forcing(*STATE))


def test_a_damaged_library_does_not_end_the_process():
    """Pages of a mapped file that are not there would end it with SIGBUS."""
    code = (
        "import pickle, sys; library = pickle.loads(sys.stdin.buffer.read())\n"
        "print(library.forcing([0.1, 0.2], [0.3, 0.4]).tobytes().hex())"
    )
    library = load(source(), flags="-O0")
    path = library.path
    whole = path.read_bytes()
    for size in (4096, len(whole) - 1):
        path.unlink()
        path.write_bytes(whole[:size])
        done = subprocess.run(
            [sys.executable, "-c", code],
            input=pickle.dumps(library),
            capture_output=True,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            check=False,
        )
        assert done.returncode == 0, done.stderr
        assert done.stdout.decode().strip() == library.forcing(*STATE).tobytes().hex()
        assert path.stat().st_size == len(whole)


# Limits


def test_what_was_not_used_for_the_longest_time_is_removed(monkeypatch):
    """Beyond 50 kB the cache is emptied to 40 kB: of eight entries of 10 kB four remain."""
    monkeypatch.setenv("KANEGEN_CACHE_MB", "0.05")
    for number in range(5):
        make(str(number), text="x" * 9_500)
        age(str(number), 10_000 - 100 * number)
    make("1")  # a use
    assert len(cache.entries()) == 5
    make("new", text="x" * 9_500)
    names = [entry.path.name for entry in cache.entries()]
    assert names == [cache.key([name]) for name in ("3", "4", "1", "new")]


def test_what_was_used_in_the_last_hour_is_kept(monkeypatch):
    monkeypatch.setenv("KANEGEN_CACHE_MB", "0")
    for name, seconds in (("old", 4_000), ("young", 3_000)):
        make(name)
        age(name, seconds)
    make("new")
    assert [entry.path.name for entry in cache.entries()] == [cache.key(["young"]), cache.key(["new"])]


def test_a_cache_that_cannot_be_emptied_is_still_used(monkeypatch):
    def fails(root, limit, added):
        raise PermissionError

    monkeypatch.setattr(cache, "_keep_below", fails)
    assert make("one") == ("content", 1)


def test_clear_removes_what_was_not_used_and_nothing_else(folder):
    assert cache.clear() == []
    for name in ("old", "new"):
        make(name)
    age("old", 90_000)
    (folder / "notes").mkdir()
    (folder / "notes" / "file").touch()
    (folder / ("f" * 32)).touch()
    assert [entry.path.name for entry in cache.clear(86_400)] == [cache.key(["old"])]
    assert [entry.path.name for entry in cache.clear()] == [cache.key(["new"])]
    assert {path.name for path in folder.iterdir()} == {"notes", "f" * 32}


def test_entries_say_what_they_hold_and_how_large_they_are():
    make("one", text="x" * 1000, file="libarm.so")
    (entry,) = cache.entries()
    digests = (entry.path / "SHA256SUMS").stat().st_size
    assert (entry.name, entry.size) == ("libarm.so", 1000 + len("int x;") + digests)
    assert abs(entry.last_use - time.time()) < 60


def test_a_loaded_library_outlives_its_entry():
    library = load(source())
    expected = bits(library.forcing(*STATE))
    assert library.path in [entry.path / entry.name for entry in cache.clear()]
    assert not library.path.exists()
    assert bits(library.forcing(*STATE)) == expected
    again = load(source())
    assert again.path == library.path
    assert bits(again.forcing(*STATE)) == expected


def test_a_build_that_runs_is_not_cleared(folder):
    """Clearing removes complete entries and what killed processes left, not what a process writes."""
    folder.mkdir()
    with temporary_folder(folder) as own:
        (own / "half").touch()
        make("one")
        cache.clear()
        assert (own / "half").exists()
    assert list(folder.iterdir()) == []


def test_a_cache_of_the_administrator_that_cannot_be_written_is_read(monkeypatch, folder):
    path = build(source())
    monkeypatch.setattr(cache, "_make", None)
    monkeypatch.setattr(os, "utime", None)
    assert build(source()) == path
