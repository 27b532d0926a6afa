"""The worst states that searches have found so far, by case of X35; every search begins with them.

A state is {x}, {y} and {tau} in a row. Replace one by what the report of a nightly run shows.
"""

from __future__ import annotations

WORST: dict[str, str] = {
    "3 rods, double": (
        "-0x1.f1c372a05d9b9p-2 0x1.aa607df4a79dbp-1 -0x1.1a9b0fdb4e929p+1 0x1.56fccf389280fp-2 "
        "-0x1.a59bef9a06792p-1 -0x1.ff8ff0658719ap+1 -0x1.87918dafc179cp+3 0x1.0035e2a1c3cc3p+0 "
        "-0x1.2af92f958cee4p+1"
    ),
    "3 hinges, double": (
        "0x1.055950ad014c3p+1 -0x1.2587f64cdc01bp+1 0x1.78cd85c09ca07p+0 -0x1.25cfc9857bff2p-1 "
        "-0x1.a97893b803712p+0 0x1.70d3b67d3de30p-3 0x1.bd6aa3f24aa57p+4 -0x1.85133bcec898cp+3 "
        "0x1.0e63255238c6cp+0"
    ),
    "a body with six freedoms, double": (
        "-0x1.2c2f674c94f9ep+1 -0x1.5232b559f097dp-7 0x1.22a86a78b1c3ep+1 0x1.28a5af558ce35p-2 "
        "-0x1.700cec671d6d3p-1 0x1.0b5b2b990b338p-1 0x1.3d351c1aafb7dp+1 -0x1.78a88921b120dp+1 "
        "0x1.6201431ed132bp+1 0x1.5353650e0c1f1p+1 -0x1.6d3498576d2d9p+1 -0x1.1078e734fc2f3p-2 "
        "-0x1.9efd7c98ef754p+1 -0x1.0eef61747a672p-7 0x1.9a7feacd51083p+1 0x1.2187093fc2facp+2 "
        "-0x1.395c721d721fcp+3 0x1.b3b1bcefc3e2dp+2"
    ),
    "3 rods, float": (
        "0x1.79a1380000000p+1 0x1.1d97960000000p+0 0x1.583e300000000p+0 -0x1.521bae0000000p-1 "
        "-0x1.747a120000000p+1 0x1.f5e8f60000000p-1 0x1.660b840000000p+5 0x1.4030f80000000p+1 "
        "0x1.6d40c60000000p+0"
    ),
    "3 hinges, float": (
        "-0x1.04a84c0000000p+0 -0x1.0b09f20000000p-2 0x1.5deb6c0000000p+1 0x1.9e63e00000000p-1 "
        "0x1.41ce5e0000000p-1 0x1.09aa540000000p+1 -0x1.3d1f920000000p+4 -0x1.0225660000000p+0 "
        "0x1.edb22e0000000p+0"
    ),
    "a body with six freedoms, float": (
        "0x1.2decc20000000p+1 -0x1.f5ee700000000p-2 -0x1.6239be0000000p+1 -0x1.17feb60000000p-3 "
        "0x1.0e31260000000p-3 0x1.14ebbe0000000p-1 -0x1.a65c0e0000000p+1 0x1.f0964c0000000p-1 "
        "0x1.5884cc0000000p+0 -0x1.9cdf0c0000000p+0 -0x1.94d8d40000000p-3 -0x1.61038a0000000p+1 "
        "0x1.dbcf9e0000000p+1 -0x1.1d53940000000p-1 -0x1.0e03d60000000p+2 -0x1.dca65c0000000p+0 "
        "0x1.cbf6360000000p+0 0x1.d76aae0000000p+2"
    ),
}
