#pragma once
/// The back ends: choice by name, device name and memory.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sim {

enum class Backend { Cpu, Cuda };

inline std::string backend_name(Backend backend) { return backend == Backend::Cpu ? "cpu" : "cuda"; }

/// The back end "cpu", "cuda" or "auto" (CUDA if a device responds, otherwise the CPU). base::Error
/// for "cuda" without a device, and for another name.
Backend choose_backend(std::string_view name);

/// Bytes of the device's memory in use, by this program or others; none on the CPU.
std::optional<std::int64_t> device_bytes_taken(Backend backend);
/// Name of the device, such as "NVIDIA H200"; empty on the CPU.
std::string device_name(Backend backend);

}  // namespace sim
