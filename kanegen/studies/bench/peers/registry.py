"""All peers by name, and the participants of a comparison built from them."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from kanegen.choices import require_one
from kanegen.errors import MissingError
from kanegen.model.system import System
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
    system: System, states: ActuatedStates, folder: Path, peers: Iterable[str] = PEERS
) -> tuple[list[Participant], list[Absence]]:
    """Build kanegen and some peers for one model, several at a time.

    Args:
        system: The model, without loads and parameters.
        states: The states that all programs compute.
        folder: Folder for files of the drivers, which must exist as long as the drivers run.
        peers: Names among `PEERS`.

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
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        futures = [(name, pool.submit(build)) for name, build in named]
    present: list[Participant] = []
    absences: list[Absence] = []
    for name, future in futures:
        try:
            present += future.result()
        except MissingError as error:
            absences.append(Absence(name, str(error)))
    return present, absences
