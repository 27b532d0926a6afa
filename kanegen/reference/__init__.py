"""The equations of the notes in NumPy: the reference against which generated code is checked.

- `freedoms`, `arguments` and `matrices` hold the order of Eq. (1), checked arrays, and the small matrices.
- `kinematics` is Eqs. (1)-(35), `equations` Eqs. (36)-(44), as they stand in the notes.
- `force_elements` and `expressions` add springs, drives, potentials and loads on points.
- `motors` adds the inertia of motors.
- `coriolis` has the parts of {f} that gravity and motion cause, and the Coriolis matrix.
- `frames` has poses, Jacobians, velocities and accelerations of frames.
- `magnitudes` says how large the terms of [A] and {f} are, and bounds rounding errors by them.
- `regularity` finds systems whose [A] is singular in every state.
- `states` makes random states in which every term counts.

The package shares no mathematics with the derivations that become C, nor with certified truth: that makes a
comparison with it a proof. It reads the model and nothing above it, and it is written for clarity, not for
speed, except that every function takes a batch of states.
"""
