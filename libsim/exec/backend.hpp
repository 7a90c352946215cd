#pragma once
/// The back ends by name.

#include <string>
#include <string_view>

namespace sim {

enum class Backend { Cpu, Cuda };

inline std::string backend_name(Backend backend) { return backend == Backend::Cpu ? "cpu" : "cuda"; }

/// "cpu", "cuda" or "auto" (CUDA when a device answers, otherwise the CPU). "cuda" without a device is a
/// base::Error.
Backend choose_backend(std::string_view name);

}  // namespace sim
