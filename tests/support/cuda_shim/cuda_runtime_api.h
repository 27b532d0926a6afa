/* The types of CUDA that headers in C name, for a machine without CUDA. */
#ifndef KANEGEN_SHIM_CUDA_RUNTIME_API_H
#define KANEGEN_SHIM_CUDA_RUNTIME_API_H

typedef struct CUstream_st *cudaStream_t;
typedef enum { cudaSuccess = 0 } cudaError_t;

static inline const char *cudaGetErrorString(cudaError_t error)
{
    return error == cudaSuccess ? "no error" : "an error";
}
#endif
