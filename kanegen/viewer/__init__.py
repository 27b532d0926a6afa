"""Pictures of a mechanism: one page that moves in any browser, and a live view.

`scene` describes bodies, shapes, joints and springs as plain data, which a page or a live view draws.
`joints` says how positions follow from {x}, `ellipsoids`, `skeleton` and `visuals` which shapes the bodies
have, `motion` holds coordinates over time, and `page` puts a scene, a motion and the bundled script into one
HTML file. `View` is what a user gets. The package reads the model, the reference and results of libraries; it
computes no dynamics.
"""
