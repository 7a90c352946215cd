#pragma once
/// The hard cases of the fluid (scenes that are difficult for the solver); each case, with its variants, is
/// defined in one file.

#include "libsim/cases/hard_case.hpp"

namespace sim::cases {

/// All methods: LoRes, HiRes, FovFluid, Ours, Ours-TSp.
std::vector<MethodKind> every_method();

HardCase rest_tank();
HardCase tall_column();
HardCase mass_interface();
HardCase tension();
HardCase big_steps();
HardCase peers_dam();
HardCase jet();
HardCase thin_sheet();
HardCase corners();
HardCase wedge();
HardCase coincident();
HardCase gaze();
HardCase energy_of_a_dam();
HardCase soak();

}  // namespace sim::cases
