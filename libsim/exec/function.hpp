#pragma once
/// What stands before a function that kernels call.

#ifdef SIM_CUDA
#include <cuda_runtime.h>
#define SIM_FN __host__ __device__ __forceinline__
#else
#define SIM_FN inline
#endif
