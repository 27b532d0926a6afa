"""Finding a compiler, compiling, and the cache, which processes may share and be killed in."""

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from kanegen.errors import BuildError
from kanegen.library.native import cache, compilers, processor, selftest
from kanegen.library.native.build import build
from kanegen.options import Variant
from kanegen.program import semantics
from tests.support.cases import slow_except
from tests.support.handmade import source
from tests.support.paths import ROOT

EVERYTHING = "\n".join((*semantics.PROPERTIES, semantics.NARROWING))

RUNS = 3
"""Runs of the compiler for a library: one for each of two files, one for the link."""

CC = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    """Return an empty cache folder; no environment variable names a compiler."""
    for variable in compilers.VARIABLES:
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def script(tmp_path):
    """Return a function that makes an executable shell script to stand for a compiler."""

    def make(text, name="fake-cc"):
        path = tmp_path / name
        path.write_text(f"#!/bin/sh\n{text}\n")
        path.chmod(0o755)
        return str(path)

    return make


@pytest.fixture
def counting(script, tmp_path):
    """Return a compiler that logs its commands, but for the self-test, and a function that reads the log."""
    log = tmp_path / "log"
    log.touch()
    command = script(f'case "$*" in --version|*selftest*) ;; *) echo "$@" >> {log} ;; esac\nexec {CC} "$@"')
    return command, lambda: log.read_text().splitlines()


def test_the_order_in_which_a_compiler_is_looked_for(script, monkeypatch, tmp_path):
    first, second, third = (script(f'exec {CC} "$@"', name) for name in ("first", "second", "gcc"))
    monkeypatch.setenv("CC", second)
    assert compilers.find().command == (second,)
    monkeypatch.setenv("KANEGEN_CC", f"{first} -pipe")
    assert compilers.find().command == (first, "-pipe")
    assert compilers.find(third).command == (third,)
    monkeypatch.delenv("CC")
    monkeypatch.delenv("KANEGEN_CC")
    monkeypatch.setenv("PATH", str(tmp_path))
    assert compilers.find().command == (third,)


def test_the_package_ziglang_is_the_last_resort(monkeypatch, tmp_path):
    package = tmp_path / "ziglang"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "__main__.py").write_text("print('a fake zig')")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv("PATH", str(tmp_path))
    found = compilers.find()
    assert found.command == (sys.executable, "-m", "ziglang", "cc")
    assert found.version == "a fake zig"


def test_no_compiler(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    with pytest.raises(BuildError, match=r"no C compiler: none of cc, gcc, clang .*\$KANEGEN_CC"):
        build(source())


@pytest.mark.parametrize(
    ("command", "message"),
    [
        ("no-such-cc -O3", "compiler: the C compiler 'no-such-cc' cannot be found"),
        ("'", 'compiler: "\'" is not a command'),
        (" ", "compiler: ' ' is not a command"),
    ],
)
def test_a_compiler_that_does_not_exist(command, message):
    with pytest.raises(BuildError, match=message):
        build(source(), command)


def test_a_variable_that_names_no_compiler(monkeypatch):
    monkeypatch.setenv("KANEGEN_CC", "no-such-cc")
    with pytest.raises(BuildError, match=r"\$KANEGEN_CC: the C compiler 'no-such-cc' cannot be found"):
        build(source())


def test_a_compiler_that_cannot_be_run(tmp_path):
    broken = tmp_path / "broken-cc"
    broken.write_text("#!/no/such/interpreter\n")
    broken.chmod(0o755)
    with pytest.raises(BuildError, match="broken-cc --version: cannot be run"):
        build(source(), str(broken))


def test_a_compiler_that_fails_shows_command_and_first_error(folder):
    with pytest.raises(BuildError, match=r"cc .* -no-such-flag .*failed with status 1 ") as caught:
        build(source(), flags=["-no-such-flag"])
    assert re.fullmatch(r".* It says: .*error.*no-such-flag.*", str(caught.value))
    assert "no-such-flag" in caught.value.__notes__[0]
    assert list(folder.iterdir()) == []


def test_a_library_is_compiled_once(counting):
    command, compilations = counting
    path = build(source(), command)
    assert path.is_file()
    assert build(source(), command) == path
    *both, link = compilations()
    assert sorted(line.split()[-3] for line in both) == ["handmade.c", "handmade_batch.c"]
    assert " ".join(source().variant.flags) == "-O2 -ffp-contract=off"
    level = "-O0"  # which tests/conftest.py puts in place of -O2
    assert all(f"{level} -march=native -ffp-contract=off" in line for line in (*both, link))
    assert {file.name for file in path.parent.iterdir()} == {
        *("handmade.h", "handmade.c", "handmade_batch.c", "kanegen_simd.h", "kanegen_sincos.h"),
        *(path.name, "SHA256SUMS"),
    }


def test_what_the_code_depends_on_is_in_the_key(counting, script):
    command, compilations = counting
    other = script(f'exec {CC} "$@"', "other-cc")
    paths = {
        build(source(), command),
        build(source(), command, ["-O1"]),
        build(source(parameters=False), command),
        build(source(), other),
    }
    assert len(paths) == 4
    assert len(compilations()) == 3 * RUNS


def test_a_new_version_of_the_compiler_compiles_anew(script):
    before = build(source(), script(f'[ "$1" = --version ] && echo 1 && exit\nexec {CC} "$@"'))
    after = build(source(), script(f'[ "$1" = --version ] && echo 2 && exit\nexec {CC} "$@"'))
    assert before != after


def test_a_compiler_that_is_replaced_compiles_anew(script):
    """Also where the new one prints the same version, and the process has asked the old one."""
    before = build(source(), script(f'exec {CC} "$@"'))
    after = build(source(), script(f'exec {CC} -fno-inline "$@"'))
    assert before != after


def test_settings_of_the_compiler_are_in_the_key(monkeypatch, tmp_path):
    before = build(source())
    monkeypatch.setenv("CPATH", str(tmp_path))
    assert build(source()) != before


@pytest.mark.parametrize("native", [{"flags": ["-march=native"]}, {"compiler": f"{CC} -march=native"}, {}])
def test_code_is_for_processors_with_the_same_features(monkeypatch, counting, native):
    """A compiler may make native code without a flag that says so, and the self-test ran on one processor.

    The name of the machine says nothing: another processor may stand behind it.
    """
    path = build(source(), **native)
    monkeypatch.setattr("platform.node", lambda: "another-name")
    assert build(source(), **native) == path
    tested = []
    monkeypatch.setattr(selftest, "_printed", lambda program, compiler: tested.append(program) or EVERYTHING)
    monkeypatch.setattr("kanegen.library.native.processor.features", lambda: "another processor")
    processor.fingerprint.cache_clear()
    selftest.properties.cache_clear()
    try:
        assert build(source(), **native) != path
    finally:
        processor.fingerprint.cache_clear()
        selftest.properties.cache_clear()
    assert len(tested) == ("flags" not in native)


def test_a_library_is_for_this_processor_by_default(counting):
    command, compilations = counting
    build(source(), command)
    assert all("-march=native" in line and "-ffp-contract=off" in line for line in compilations())


def test_a_library_for_all_processors_is_named(counting):
    command, compilations = counting
    build(replace(source(), variant=Variant(machine="portable")), command)
    assert compilations() and not any("-march" in line for line in compilations())


def test_semantics_that_may_change_bits_are_not_made_native_unasked(counting):
    command, compilations = counting
    build(replace(source(), variant=Variant(semantics="contracted")), command)
    assert compilations() and not any("-march" in line for line in compilations())


def test_a_compiler_that_does_not_know_this_machine_makes_portable_code(script, tmp_path):
    log = tmp_path / "log"
    refusing = 'case "$*" in *-march=native*) echo "error: unknown machine" >&2; exit 1 ;; esac'
    path = build(source(), script(f'{refusing}\necho "$@" >> {log}\nexec {CC} "$@"'))
    assert path.is_file() and "-O2" in log.read_text() and "-march" not in log.read_text()


@pytest.mark.skipif(sys.platform != "linux", reason="/proc/cpuinfo is a file of Linux")
def test_the_features_of_a_processor():
    known = Path("/proc/cpuinfo").read_text()
    assert processor.features() == processor._linux_features(known)
    word = processor.features().split()[-1]
    assert processor._linux_features(known.replace(f" {word}", "")) != processor.features()
    speeds = known.replace("MHz\t\t: ", "MHz\t\t: 9")
    assert processor._linux_features(speeds + "\nbogomips: 1\n") == processor.features()


@pytest.mark.parametrize("harm", ["truncate", "remove", "manifest"])
def test_a_damaged_entry_is_made_anew(counting, harm):
    command, compilations = counting
    path = build(source(), command)
    whole = path.read_bytes()
    if harm == "truncate":
        path.write_bytes(whole[:100])
    elif harm == "remove":
        path.unlink()
    else:
        (path.parent / "SHA256SUMS").write_text("")
    assert build(source(), command) == path
    assert path.read_bytes() == whole
    assert len(compilations()) == 2 * RUNS
    assert libraries(path.parents[1]) == [path.parent.name]


def libraries(folder):
    """Return the names of the entries of a cache without those of the self-test."""
    return [entry.name for entry in folder.iterdir() if not (entry / "properties").exists()]


CODE = """
from kanegen.library.native.build import build
from tests.support.handmade import source
print(build(source()))
"""


def start(**environment):
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    return subprocess.Popen(
        [sys.executable, "-c", CODE],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        start_new_session=True,
    )


@pytest.mark.parametrize("number", slow_except((2, 4), 2))
def test_processes_may_build_the_same_at_once(number, folder, script, tmp_path):
    """The compiler waits until every process compiles both files, so all make the same entry at once."""
    arrived = tmp_path / "arrived"
    arrived.mkdir()
    wait = f'touch {arrived}/$$; until [ "$(ls {arrived} | wc -l)" -ge {2 * number} ]; do sleep 0.02; done'
    command = script(f'case "$*" in --version|*selftest*) ;; *) {wait} ;; esac\nexec {CC} "$@"')
    processes = [start(KANEGEN_CC=command) for _ in range(number)]
    paths = {process.communicate(timeout=60)[0].strip() for process in processes}
    assert [process.returncode for process in processes] == [0] * number
    (path,) = paths
    assert Path(path).is_file()
    assert libraries(folder) == [Path(path).parent.name]


def test_a_killed_build_does_no_harm(folder, script):
    """What a process leaves that is killed while it compiles is never used, and removed by the next one."""
    slow = script(
        f'case "$1" in --version) exec {CC} --version ;; esac\necho half > libhandmade.so; sleep 60'
    )
    process = start(KANEGEN_CC=slow)
    deadline = time.monotonic() + 30
    while not list(folder.glob("*/*/libhandmade.so")) and time.monotonic() < deadline:
        time.sleep(0.02)
    (unfinished,) = folder.iterdir()
    assert build(source(), flags=["-O1"]).stat().st_size > 1000
    assert unfinished.exists()  # its process still compiles
    os.killpg(process.pid, signal.SIGKILL)
    process.communicate()

    path = build(source())
    assert path.stat().st_size > 1000
    assert not unfinished.exists()
    assert {entry.name[0] for entry in folder.iterdir()} <= set("0123456789abcdef")


HANGS = 'case "$*" in --version|*selftest*) exec {cc} "$@" ;; esac\nsleep 60 & echo $! > {child}; wait'


def is_running(pid):
    state = subprocess.run(["ps", "-o", "stat=", "-p", pid], capture_output=True, text=True, check=False)
    return state.stdout.strip()[:1] not in ("", "Z")


def test_a_compiler_that_hangs_is_stopped(folder, script, monkeypatch, tmp_path):
    build(source())  # the self-test is not to be in a hurry
    hanging = script(HANGS.format(cc=CC, child=tmp_path / "child"))
    compilers.find(hanging)
    selftest.sound_flags(compilers.find(hanging), source())
    monkeypatch.setenv("KANEGEN_COMPILE_SECONDS", "1.5")
    with pytest.raises(
        BuildError,
        match=r"took more than 1\.5 s\. If the compiler does not hang, set \$KANEGEN_COMPILE_SECONDS",
    ):
        build(source(), hanging)
    assert not is_running((tmp_path / "child").read_text().strip())
    assert not [entry for entry in folder.iterdir() if entry.name.startswith(".")]


def test_a_compiler_that_hangs_at_its_version_is_stopped(script, monkeypatch):
    monkeypatch.setattr(compilers, "_TIME_LIMIT", 0.3)
    with pytest.raises(BuildError, match=r"--version: took more than 0\.3 s\. Does this compiler wait"):
        build(source(), script("sleep 60"))


@pytest.mark.parametrize("text", ["soon", "-1", "nan"])
@pytest.mark.parametrize("variable", ["KANEGEN_COMPILE_SECONDS", "KANEGEN_CACHE_MB"])
def test_limits_that_are_none(monkeypatch, folder, variable, text):
    monkeypatch.setenv(variable, text)
    with pytest.raises(BuildError, match=rf"\${variable}: '{text}' is not a number from 0 to inf"):
        build(source())
    assert not [entry for entry in folder.iterdir() if (entry / "libhandmade.so").exists()]


def test_an_interrupted_build_kills_its_compilers(folder, script, tmp_path):
    """SIGINT while two files are compiled: no compiler runs on, and nothing half-written stays."""
    hanging = script(HANGS.format(cc=CC, child=f"{tmp_path}/child-$$"))
    process = start(KANEGEN_CC=hanging)
    deadline = time.monotonic() + 30
    while len(list(tmp_path.glob("child-*"))) < 2 and time.monotonic() < deadline:
        time.sleep(0.02)
    begun = time.monotonic()
    process.send_signal(signal.SIGINT)
    process.communicate()
    assert time.monotonic() - begun < 40  # the compilers would take 60 s
    assert process.returncode == -signal.SIGINT  # an interpreter that KeyboardInterrupt ends
    children = [path.read_text().strip() for path in tmp_path.glob("child-*")]
    assert len(children) == 2
    assert not any(map(is_running, children))
    assert libraries(folder) == []


def test_the_folder_of_the_cache(monkeypatch, tmp_path):
    monkeypatch.delenv(cache.VARIABLE)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert "kanegen" in cache.folder().parts
    if sys.platform == "linux":
        assert cache.folder() == tmp_path / "kanegen"


def test_a_cache_folder_that_cannot_be_used(monkeypatch, tmp_path):
    (tmp_path / "file").touch()
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "file" / "cache"))
    with pytest.raises(BuildError, match=r"cache folder .*file.cache cannot be used: .*Set \$KANEGEN_CACHE"):
        build(source())


def test_keys_depend_on_where_parts_end():
    assert cache.key(["ab", "c"]) != cache.key(["a", "bc"]) != cache.key(["a", "b", "c"])


def test_a_compiler_that_writes_nothing_has_failed():
    with pytest.raises(BuildError, match=r"made no .*selftest"):
        build(source(), compiler="true")


def test_flags_may_be_one_string():
    split = build(source(), flags=("-O1", "-ffp-contract=off"))
    assert build(source(), flags="-O1 -ffp-contract=off") == split


def test_a_compiler_is_named_by_a_string():
    with pytest.raises(BuildError, match="5 is not a command"):
        build(source(), compiler=5)
