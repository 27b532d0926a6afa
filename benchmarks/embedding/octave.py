"""Octave: calls of a mex file by itself, through its package, and of many states."""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

import kanegen as kg
from benchmarks.embedding import arm
from benchmarks.embedding.alone import in_c
from benchmarks.embedding.answering import answering
from benchmarks.embedding.row import SECONDS, Row, in_turns
from kanegen.errors import MissingError
from kanegen.options import Variant

STATES = 1000
"""States of a call for many."""

CALLS = {
    "mex file": "panda_arm_mex('forward_dynamics', x, y, tau)",
    "package": "panda_arm.forward_dynamics(x, y, tau)",
}
"""Calls by their description."""

MANY = "panda_arm.forward_dynamics(xs, ys, taus)"

END = "\n"
"""What stands behind a call: `fgetl` answers when it knows whether something follows its line."""

SCRIPT = """\
x = [{x}]'; y = [{y}]'; tau = [{tau}]';
xs = repmat(x, 1, {states}); ys = repmat(y, 1, {states}); taus = repmat(tau, 1, {states});
while ischar(line = fgetl(stdin))
  if isempty(line)
    continue;
  end
  count = 1;
  do
    start = tic();
    eval(['for i = 1:count, a = ' line '; end']);
    taken = toc(start);
    count *= 2;
  until taken >= {seconds}
  printf('%.9g\\n', 2e9*taken/count); fflush(stdout);
end
"""


def measure() -> list[Row]:
    """Measure accelerations of panda_arm; the mex file is compiled for every processor, as the C alone.

    Raises:
        MissingError: If Octave or its development files are not installed.
    """
    if shutil.which("octave") is None or shutil.which("mkoctfile") is None:
        raise MissingError("Octave is not installed (apt-get install octave octave-dev)")
    system = kg.load("models/panda_arm.toml")
    source = kg.generate(system, ("forward_dynamics",), tier=Variant(machine="portable"), artifacts="octave")
    inputs = arm.states()
    alone = in_c(source, "forward_dynamics", inputs)
    many = {name: np.tile(value, (STATES, 1)) for name, value in inputs.items()}
    alone_many = in_c(source, "forward_dynamics", many, STATES)
    octave = ["octave", "--no-gui", "--norc", "--quiet"]
    with tempfile.TemporaryDirectory() as name:
        folder = source.write(Path(name) / "code")
        numbers = {one: " ".join(map(repr, value.tolist())) for one, value in inputs.items()}
        (folder / "turns.m").write_text(SCRIPT.format(states=STATES, seconds=SECONDS, **numbers))
        build = ["--eval", "panda_arm.build(); disp(version())"]
        printed = subprocess.run([*octave, *build], cwd=folder, capture_output=True, text=True, check=False)
        version = f"Octave {printed.stdout.split()[-1]}"
        with answering([*octave, "turns.m"], folder) as turns:
            rows = [
                Row("Octave", f"{how}, {arm.WHAT}", *in_turns(alone, turns(call + END)), version)
                for how, call in CALLS.items()
            ]
            batch = in_turns(lambda: alone_many() / STATES, lambda: turns(MANY + END)() / STATES)
            return [*rows, Row("Octave", f"package, {STATES} states, each, {arm.WHAT}", *batch, version)]
