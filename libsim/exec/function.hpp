#pragma once
/// Prefix of functions that kernels call; APART: for rarely used ones, which are not inlined.

#ifdef SIM_CUDA
#include <cuda_runtime.h>
#define SIM_FN __host__ __device__ __forceinline__
#define SIM_FN_APART __host__ __device__ __noinline__
#else
#define SIM_FN inline
#define SIM_FN_APART [[gnu::noinline]] inline
#endif
