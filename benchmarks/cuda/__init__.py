"""Kernels for GPUs: registers as NVIDIA's compiler counts them, and states a second on a card."""
