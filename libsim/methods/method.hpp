#pragma once
/// The methods under study, as data, and particle counts as users write them.

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace sim {

enum class MethodKind { LoRes, HiRes, FovFluid, Ours, OursTsp };

/// Number of mass levels, 0 .. 3. A particle of level l has 2^l times m_*, the mass of the finest particles.
inline constexpr int most_levels = 4;

/// Source of the level that a particle should have.
enum class TargetSource {
  None,     ///< no targets: particles keep their levels
  Gaze,     ///< the gaze: the finest level in the fovea, the coarsest in the periphery, the other levels
            ///< between (like FovFluid, [42] in ViP-Fluid)
  Saliency  ///< visual saliency, Eq. 1-9
};

/// The properties of a method, from which the schedule selects the solver's stages.
struct MethodTraits {
  MethodKind kind{};
  const char* name = "";
  TargetSource target = TargetSource::None;
  bool temporal = false;  ///< temporal acceleration (Alg. 3)
  int start_level = 0;    ///< level of the particles that fill the scene before frame 0

  /// True if particles split and merge.
  bool adaptive() const { return target != TargetSource::None; }
};

/// The five methods, in the order of ViP-Fluid's tables.
const std::array<MethodTraits, 5>& all_methods();
const MethodTraits& traits_of(MethodKind method);

/// "LoRes", "HiRes", "FovFluid", "Ours", "Ours-TSp" (any case); any other name is a base::Error that lists
/// the known names.
MethodKind parse_method(std::string_view name);
std::string method_name(MethodKind method);
/// "LoRes, HiRes, FovFluid, Ours or Ours-TSp", for help texts and errors.
std::string method_names();

/// Parses n_*, the number of particles if all have the coarsest level: "16k" = 16,384; "4096" = 4,096.
/// base::Error outside 64 .. 4,194,304 (4096k), and for other texts.
std::int64_t parse_n_star(std::string_view text);

/// Number of particles at frame 0 if no obstacle displaces water: 8 n_* for a method that starts at level 0,
/// n_* for a method that starts at level 3. In scenes without outlets, the number of particles of LoRes and
/// HiRes does not change during a run.
std::int64_t particle_count(MethodKind method, std::int64_t n_star);

}  // namespace sim
