"""Who takes part on a model, and why somebody does not."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from kanegen.choices import require_one
from kanegen.errors import MissingError
from kanegen.model.system import System
from kanegen.studies.bench.contestant import Contestant
from kanegen.studies.bench.outcome import Absence
from kanegen.studies.bench.peers import casadi_peer, kanegen_peer, mujoco_peer, pinocchio_peer, pydy_peer
from kanegen.studies.bench.peers.arena import Arena, Makers
from kanegen.studies.bench.states import States

PEERS: dict[str, Callable[[Arena], Makers]] = {
    "pinocchio": pinocchio_peer.makers,
    "casadi": casadi_peer.makers,
    "mujoco": mujoco_peer.makers,
    "pydy": pydy_peer.makers,
}
"""Beside kanegen."""


def contestants(
    system: System, states: States, folder: Path, peers: Iterable[str] = PEERS
) -> tuple[list[Contestant], list[Absence]]:
    """Everybody who can take part, Pinocchio in the same coordinates first, and the others with the reason.

    Args:
        system: Without loads and parameters.
        states: That everybody computes.
        folder: For the files of the drivers, as long as they are called.
        peers: Names among `PEERS`.

    Raises:
        OptionError: If a peer is unknown.
    """
    wanted = list(peers)
    for name in wanted:
        require_one("peer", name, PEERS)
    arena = Arena(system, states, states.write(folder / "states"), folder)
    order = {"pinocchio": pinocchio_peer.makers, "kanegen": kanegen_peer.makers, **PEERS}
    makers = [
        maker for name, all_of in order.items() if name in (*wanted, "kanegen") for maker in all_of(arena)
    ]
    with ThreadPoolExecutor(max_workers=os.cpu_count()) as pool:
        futures = [(name, pool.submit(make)) for name, make in makers]
    present: list[Contestant] = []
    absences: list[Absence] = []
    for name, future in futures:
        try:
            present += future.result()
        except MissingError as error:
            absences.append(Absence(name, str(error)))
    return present, absences
