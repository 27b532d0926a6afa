/*
 * The words of CUDA C++ for a processor: kernels are functions, whose blocks run one after the other.
 *
 * The threads of a block are fibers of one thread of the processor. Each runs to its end, or to __syncthreads(), where the
 * next goes on; after the last of them the first leaves the barrier. Memory that is __shared__ is that of the only block
 * that runs. The order is always the same, so a race between barriers shows as wrong numbers or as numbers that differ
 * from those of the order in which threads run backwards, KANEGEN_SHIM_BACKWARDS.
 */
#ifndef KANEGEN_SHIM_CUDA_RUNTIME_H
#define KANEGEN_SHIM_CUDA_RUNTIME_H

#include "cuda_runtime_api.h"

#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <ucontext.h>

#include <functional>
#include <tuple>
#include <utility>
#include <vector>

#define __global__
#define __device__
#define __host__
#define __forceinline__ inline
#define __noinline__ __attribute__((noinline))
#define __launch_bounds__(...)
#define __shared__ static

struct dim3 {
    unsigned int x, y, z;
    dim3(unsigned int first = 1, unsigned int second = 1, unsigned int third = 1) : x(first), y(second), z(third) {}
};

namespace shim {
inline dim3 thread_index, block_index, block_size, grid_size;
inline ucontext_t scheduler;
inline std::vector<ucontext_t> fibers;
inline std::vector<char> has_ended;
inline std::function<void()> body;
inline unsigned int current;
inline size_t barriers;

/* What a fiber runs. */
inline void run()
{
    body();
    has_ended[current] = 1;
}

/* Runs the threads of one block, in turns between barriers. */
inline void run_block(unsigned int threads)
{
    static std::vector<std::vector<char>> stacks;
    constexpr size_t size = size_t(1) << 18;
    fibers.assign(threads, ucontext_t());
    has_ended.assign(threads, 0);
    stacks.resize(threads);
    for (unsigned int k = 0; k < threads; ++k) {
        stacks[k].resize(size);
        getcontext(&fibers[k]);
        fibers[k].uc_stack.ss_sp = stacks[k].data();
        fibers[k].uc_stack.ss_size = size;
        fibers[k].uc_link = &scheduler;
        makecontext(&fibers[k], run, 0);
    }
    for (bool is_running = true; is_running;) {
        is_running = false;
        for (unsigned int k = 0; k < threads; ++k) {
#ifdef KANEGEN_SHIM_BACKWARDS
            current = threads - 1 - k;
#else
            current = k;
#endif
            if (!has_ended[current]) {
                thread_index = dim3(current);
                swapcontext(&scheduler, &fibers[current]);
                is_running = true;
            }
        }
    }
}
} // namespace shim

#define threadIdx shim::thread_index
#define blockIdx shim::block_index
#define blockDim shim::block_size
#define gridDim shim::grid_size

inline void __syncthreads()
{
    ++shim::barriers;
    swapcontext(&shim::fibers[shim::current], &shim::scheduler);
    shim::thread_index = dim3(shim::current);
}

/* Memory of the device is memory of the processor. */
typedef enum { cudaMemcpyHostToDevice = 1, cudaMemcpyDeviceToHost = 2 } cudaMemcpyKind;

inline cudaError_t cudaMalloc(void **memory, size_t bytes)
{
    *memory = malloc(bytes);
    return cudaSuccess;
}

inline cudaError_t cudaFree(void *memory)
{
    free(memory);
    return cudaSuccess;
}

inline cudaError_t cudaMemcpy(void *to, const void *from, size_t bytes, cudaMemcpyKind)
{
    memcpy(to, from, bytes);
    return cudaSuccess;
}

template <typename... Parameters, size_t... Places>
void shim_call(void (*kernel)(Parameters...), void **arguments, std::index_sequence<Places...>)
{
    kernel(*static_cast<Parameters *>(arguments[Places])...);
}

/* The blocks of a kernel one after the other. */
template <typename... Parameters>
cudaError_t cudaLaunchKernel(
    void (*kernel)(Parameters...), dim3 grid, dim3 block, void **arguments, size_t, cudaStream_t)
{
    shim::grid_size = grid;
    shim::block_size = block;
    shim::body = [=] { shim_call(kernel, arguments, std::index_sequence_for<Parameters...>()); };
    for (unsigned int k = 0; k < grid.x; ++k) {
        shim::block_index = dim3(k);
        shim::run_block(block.x);
    }
    return cudaSuccess;
}
#endif
