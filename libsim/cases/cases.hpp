#pragma once
/// The cases, one file each.

#include "libsim/cases/hard_case.hpp"

namespace sim::cases {

/// LoRes, HiRes, FovFluid, Ours, Ours-TSp.
std::vector<MethodKind> every_method();

HardCase tall_column();
HardCase big_steps();
HardCase peers_dam();
HardCase jet();

}  // namespace sim::cases
