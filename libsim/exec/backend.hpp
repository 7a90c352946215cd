#pragma once
/// The back ends by name.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace sim {

enum class Backend { Cpu, Cuda };

inline std::string backend_name(Backend backend) { return backend == Backend::Cpu ? "cpu" : "cuda"; }

/// "cpu", "cuda" or "auto" (CUDA when a device answers, otherwise the CPU). "cuda" without a device is a
/// base::Error.
Backend choose_backend(std::string_view name);

/// Bytes of the device's memory that are taken, by this program or another; none on the CPU.
std::optional<std::int64_t> device_bytes_taken(Backend backend);
/// What the device calls itself, such as "NVIDIA H200"; empty on the CPU.
std::string device_name(Backend backend);

}  // namespace sim
