#pragma once
/// The methods under study, as data, and particle counts as users write them.

#include <cstdint>
#include <string>
#include <string_view>

namespace sim {

enum class MethodKind { LoRes, HiRes };

/// "LoRes", "HiRes" (any case); others are a base::Error naming the known ones.
MethodKind parse_method(std::string_view name);
std::string method_name(MethodKind method);

/// "16k" = 16,384; "4096" = 4,096. The paper's n_*: particles when all are coarsest. 64 .. 4M, else
/// base::Error.
std::int64_t parse_n_star(std::string_view text);

/// LoRes holds n_*, HiRes 8 n_* particles at every step.
std::int64_t particle_count(MethodKind method, std::int64_t n_star);

}  // namespace sim
