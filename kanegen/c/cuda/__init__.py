"""The target CUDA: device functions for one state, kernels for many, and functions that launch them."""

from __future__ import annotations

from kanegen.c.cuda.target import CUDA_TARGET, Cuda

__all__ = ["CUDA_TARGET", "Cuda"]
