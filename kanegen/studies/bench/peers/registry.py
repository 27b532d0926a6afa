"""All peers by name, and the participants of a comparison built from them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path

from kanegen.choices import require_one
from kanegen.errors import MissingError, counted
from kanegen.model.system import System
from kanegen.options import Progress, quiet
from kanegen.reference.states import ActuatedStates
from kanegen.studies.bench.comparison import Absence
from kanegen.studies.bench.participant import Participant
from kanegen.studies.bench.peers import (
    casadi_peer,
    dynibo_peer,
    frax_peer,
    kanegen_peer,
    mujoco_peer,
    pinocchio_code_peer,
    pinocchio_peer,
    pydy_peer,
)
from kanegen.studies.bench.peers.problem import Builders, Problem
from kanegen.studies.bench.states import write_states

PEERS: dict[str, Callable[[Problem], Builders]] = {
    "pinocchio": pinocchio_peer.builders,
    "pinocchio-code": pinocchio_code_peer.builders,
    "casadi": casadi_peer.builders,
    "mujoco": mujoco_peer.builders,
    "dynibo": dynibo_peer.builders,
    "frax": frax_peer.builders,
    "pydy": pydy_peer.builders,
}
"""The builders of every peer by its name on the command line."""


def participants(
    system: System,
    states: ActuatedStates,
    folder: Path,
    peers: Iterable[str] = PEERS,
    progress: Progress = quiet,
) -> tuple[list[Participant], list[Absence]]:
    """Build kanegen and some peers for one model, several at a time.

    Args:
        system: The model, without loads and parameters.
        states: The states that all programs compute.
        folder: Folder for files of the drivers, which must exist as long as the drivers run.
        peers: Names among `PEERS`.
        progress: Function that receives the name of each stage.

    Returns:
        The participants, Pinocchio in kanegen's coordinates first, and the programs that cannot take part.

    Raises:
        OptionError: If a peer is unknown.
    """
    wanted = list(peers)
    for name in wanted:
        require_one("peer", name, PEERS)
    problem = Problem(system, states, write_states(states, folder / "states"), folder)
    order = {"pinocchio": pinocchio_peer.builders, "kanegen": kanegen_peer.builders, **PEERS}
    chosen = [builders for name, builders in order.items() if name in (*wanted, "kanegen")]
    named = [builder for builders in chosen for builder in builders(problem)]
    progress(f"building {counted(len(named), 'program')}; Pinocchio takes minutes the first time")
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        futures = {pool.submit(build): name for name, build in named}
        for number, future in enumerate(as_completed(futures), start=1):
            word = "left out" if future.exception() else "built"
            progress(f"{word}: {futures[future]}, {number} of {len(named)}")
    present: list[Participant] = []
    absences: list[Absence] = []
    for future, name in futures.items():
        try:
            present += future.result()
        except MissingError as error:
            absences.append(Absence(name, str(error)))
    return present, absences
