#pragma once
/// SIM_TEST(Suite, Name) is Suite.Name for the CPU and SuiteGpu.Name (label gpu) for CUDA.

#include <gtest/gtest.h>

#ifdef SIM_CUDA
#define SIM_TEST(suite, name) TEST(suite##Gpu, name)
#else
#define SIM_TEST(suite, name) TEST(suite, name)
#endif
