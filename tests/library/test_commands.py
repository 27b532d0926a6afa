"""Commands that are run with a time limit, and programs from several sources behind the cache."""

import subprocess
import sys
import time
from itertools import accumulate

import pytest

from kanegen.errors import BuildError
from kanegen.library.native import cache, commands, processor
from kanegen.library.native.build import program

MAIN = '#include "part.h"\n#include <stdio.h>\nint main(void) { printf("%d\\n", part()); return 0; }\n'
PART = {
    "part.h": "int part(void);\n",
    "parts/part.c": '#include "part.h"\nint part(void) { return VALUE; }\n',
}


def test_a_command_that_exceeds_its_time_limit_is_killed_with_its_children(tmp_path):
    script = f"sleep 30 & echo $! > {tmp_path}/child; wait"
    start = time.monotonic()
    with pytest.raises(commands.TimeLimitError, match=r"took more than 0\.5 s") as caught:
        commands.run(["/bin/sh", "-c", script], seconds=0.5)
    assert time.monotonic() - start < 20
    assert caught.value.seconds == 0.5
    child = (tmp_path / "child").read_text().strip()
    state = subprocess.run(["ps", "-o", "stat=", "-p", child], capture_output=True, text=True, check=False)
    assert state.stdout.strip() in ("", "Z", "Zs")


def test_output_of_a_command():
    assert commands.output([sys.executable, "-c", "print(3)"], seconds=60) == "3\n"
    with pytest.raises(commands.CommandError, match=r"failed with status 7\. It says: an error\n") as caught:
        text = "import sys; print('first\\nan error', file=sys.stderr); sys.exit(7)"
        commands.output([sys.executable, "-c", text])
    assert caught.value.reason == "an error"
    assert str(caught.value).isprintable()
    assert caught.value.__notes__ == ["Its output:\nfirst\nan error\n"]
    assert isinstance(caught.value, BuildError)


def test_a_program_is_compiled_once_from_files_in_folders(tmp_path, monkeypatch):
    monkeypatch.setenv(cache.VARIABLE, str(tmp_path / "cache"))
    files = {"main.c": MAIN, **PART}
    flags = {"main.c": ["-O0"], "parts/part.c": ["-O0", "-DVALUE=4"]}
    path = program("four", files, flags, seconds=60)
    assert commands.output([path]) == "4\n"
    made = path.stat().st_mtime_ns
    assert program("four", files, flags) == path
    assert path.stat().st_mtime_ns == made
    other = program("four", files, {**flags, "parts/part.c": ["-O0", "-DVALUE=5"]})
    assert (other != path, commands.output([other])) == (True, "5\n")


def test_many_commands_run_in_order_and_few_at_a_time(tmp_path, monkeypatch):
    monkeypatch.setattr(processor, "usable", lambda: 2)
    script = f"echo 1 >> {tmp_path}/log; sleep 0.05; echo -1 >> {tmp_path}/log; echo "
    done = commands.run_all([["/bin/sh", "-c", f"{script}{k}"] for k in range(12)], seconds=60)
    assert [int(one.stdout) for one in done] == list(range(12))
    running = list(accumulate(int(line) for line in (tmp_path / "log").read_text().split()))
    assert (len(running), running[-1]) == (24, 0)
    assert 1 < max(running) <= 4
