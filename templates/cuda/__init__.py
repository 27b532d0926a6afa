"""Code in CUDA C++: device functions, kernels and the functions that launch them."""
