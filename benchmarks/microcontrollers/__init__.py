"""Generated C on microcontrollers in QEMU: bits of results, instructions, stack and flash memory.

`python -m benchmarks.microcontrollers` writes docs/embedding/microcontroller-costs.md; tests use its boards.
"""
