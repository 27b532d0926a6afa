"""The participants of a comparison: kanegen itself and the programs beside which it is timed.

`problem` holds the model and states of all participants, `joints` the tree in the form that the peers take.
One module for each peer, `<peer>_peer.py`, has a function `builders`; `registry` holds all of them by name. A
module that imports its peer's package, such as `casadi_code`, is imported only when that peer is built.
"""
