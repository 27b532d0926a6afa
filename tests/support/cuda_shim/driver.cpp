/*
 * The part of CUDA's driver interface that benchmarks/cuda/card.py calls, for kernels that are compiled with the shim and
 * linked to it. Memory of the card is memory of the processor; events lie a millisecond apart.
 */
#include "cuda_runtime.h"

#include <dlfcn.h>

#include <utility>

typedef uint64_t word;
typedef void (*kernel)(word, word, word, word, word, word, word);

template <size_t... Places> static void call(void *function, void **arguments, std::index_sequence<Places...>)
{
    reinterpret_cast<kernel>(function)(*static_cast<word *>(arguments[Places])...);
}

extern "C" {
int cuInit(unsigned int) { return 0; }
int cuDeviceGet(int *device, int) { *device = 0; return 0; }
int cuDevicePrimaryCtxRetain(void **context, int) { *context = nullptr; return 0; }
int cuCtxSetCurrent(void *) { return 0; }
int cuDeviceGetName(char *name, int size, int) { strncpy(name, "the processor", static_cast<size_t>(size)); return 0; }
int cuDeviceGetAttribute(int *value, int number, int) { *value = number == 75 ? 9 : 0; return 0; }
int cuGetErrorString(int, const char **text) { *text = "an error"; return 0; }
int cuModuleLoadData(void **loaded, const void *) { *loaded = nullptr; return 0; }
int cuModuleGetFunction(void **function, void *, const char *name)
{
    *function = dlsym(RTLD_DEFAULT, name);
    return *function == nullptr;
}
int cuMemAlloc_v2(word *address, size_t size)
{
    *address = reinterpret_cast<word>(malloc(size));
    return 0;
}
int cuMemFree_v2(word address) { free(reinterpret_cast<void *>(address)); return 0; }
int cuMemcpyHtoD_v2(word to, const void *from, size_t size)
{
    memcpy(reinterpret_cast<void *>(to), from, size);
    return 0;
}
int cuMemcpyDtoH_v2(void *to, word from, size_t size)
{
    memcpy(to, reinterpret_cast<const void *>(from), size);
    return 0;
}
int cuEventCreate(void **event, unsigned int) { *event = nullptr; return 0; }
int cuEventRecord(void *, void *) { return 0; }
int cuEventSynchronize(void *) { return 0; }
int cuEventElapsedTime(float *elapsed, void *, void *) { *elapsed = 1.0f; return 0; }
int cuEventDestroy_v2(void *) { return 0; }
int cuLaunchKernel(void *function, unsigned int blocks, unsigned int, unsigned int, unsigned int threads, unsigned int,
    unsigned int, unsigned int, void *, void **arguments, void **)
{
    shim::grid_size = dim3(blocks);
    shim::block_size = dim3(threads);
    shim::body = [=] { call(function, arguments, std::make_index_sequence<7>()); };
    for (unsigned int k = 0; k < blocks; ++k) {
        shim::block_index = dim3(k);
        shim::run_block(threads);
    }
    return 0;
}
}
