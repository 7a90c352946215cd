#pragma once
/// Effects that a scene may list in addition to the method's own stages. Unlisted effects cost nothing.

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace base {
class TomlTable;
}

namespace sim {

inline constexpr double rest_density_kg_m3 = 1000;
/// Largest coefficient of an effect, in the effect's unit.
inline constexpr double largest_coefficient = 1e6;

/// Unit of an effect's coefficient c. It gives the formula of the effect's natural time T, from c, the rest
/// density rho_0 and the finest spacing d. The longest stable substep of an effect is a multiple of its T.
enum class EffectUnit {
  NewtonPerMetre,         ///< T = sqrt(rho_0 d^3 / c)
  PerSecond,              ///< T = 1 / c
  MetrePerSecond,         ///< T = d / c
  MetreSquaredPerSecond,  ///< T = d^2 / c
  Unlimited               ///< any unit, stable for any step: T is infinite
};

// The registry, one row per effect: EFFECT(enumerator, word in the scene file, key of its coefficient, unit,
// longest stable substep in T, a required effect or none, source). The stages of a row come from the function
// WORD_stages() in one file of libsim/solver/effects; they run in the table's order.
#define SIM_EFFECTS(EFFECT)                                                        \
  EFFECT(Viscosity, viscosity, viscosity_m2_s, Unlimited, 1, no_effect,            \
         "Weiler et al. 2018, implicit, of pairs of any size")                     \
  EFFECT(Cohesion, cohesion, tension_n_m, NewtonPerMetre, 0.2, no_effect,          \
         "Akinci et al. 2013, cohesion and curvature, as energies of the surface") \
  EFFECT(Adhesion, adhesion, work_n_m, NewtonPerMetre, 0.2, EffectKind::Cohesion,  \
         "Akinci et al. 2013, adhesion, of a plane")                               \
  EFFECT(AirDrag, air_drag, rate_per_s, PerSecond, 0.5, no_effect,                 \
         "Macklin et al. 2014, air drag, of the exposed share")                    \
  EFFECT(Vorticity, vorticity, confinement_m_s, MetrePerSecond, 0.2, no_effect,    \
         "Macklin and Mueller 2013, vorticity confinement, of pairs of any size")  \
  EFFECT(Friction, friction, drag_m_s, Unlimited, 1, no_effect,                    \
         "Navier 1823, a stress that grows with the slip along walls")             \
  EFFECT(Heat, heat, diffusivity_m2_s, MetreSquaredPerSecond, 0.2, no_effect,      \
         "Cleary and Monaghan 1999, conduction; Boussinesq's buoyancy")            \
  EFFECT(Foam, foam, emission_per_s, Unlimited, 1, no_effect,                      \
         "Ihmsen et al. 2012, spray, foam and bubbles, by volume")

enum class EffectKind {
#define SIM_ENUMERATOR(Name, ...) Name,
  SIM_EFFECTS(SIM_ENUMERATOR)
#undef SIM_ENUMERATOR
      count
};
inline constexpr std::size_t effect_count = static_cast<std::size_t>(EffectKind::count);
inline constexpr EffectKind no_effect = EffectKind::count;

// Further parameters of effects, one row each: OPTION(enumerator, its effect, key, default, minimum,
// maximum). cg_steps = 0: as many steps as convergence needs. wall_k = 0: insulating walls. length_m = 0: a
// sixth of the edge of a cube with the volume of the water.
#define SIM_EFFECT_OPTIONS(OPTION)                                  \
  OPTION(ViscositySteps, Viscosity, cg_steps, 0, 0, 200)            \
  OPTION(ViscosityStick, Viscosity, stick, 1, 0, 1)                 \
  OPTION(ViscosityCoarsest, Viscosity, coarsest_level, 3, 0, 3)     \
  OPTION(CohesionCoarsest, Cohesion, coarsest_level, 3, 0, 3)       \
  OPTION(AirDragCoarsest, AirDrag, coarsest_level, 3, 0, 3)         \
  OPTION(VorticityFrom, Vorticity, from_per_s, 2, 0, 1e4)           \
  OPTION(VorticityMost, Vorticity, most_per_s, 50, 1e-3, 1e6)       \
  OPTION(VorticitySaliency, Vorticity, saliency_weight, 1, 0, 100)  \
  OPTION(VorticityCoarsest, Vorticity, coarsest_level, 3, 0, 3)     \
  OPTION(FrictionCoarsest, Friction, coarsest_level, 3, 0, 3)       \
  OPTION(HeatExpansion, Heat, expansion_per_k, 2.1e-4, 0, 1)        \
  OPTION(HeatReference, Heat, reference_k, 293.15, 1, 1e4)          \
  OPTION(HeatWall, Heat, wall_k, 0, 0, 1e4)                         \
  OPTION(HeatCoarsest, Heat, coarsest_level, 3, 0, 3)               \
  OPTION(FoamApproachFrom, Foam, approach_from_per_s, 0, 0, 1e4)    \
  OPTION(FoamApproachSpan, Foam, approach_span_per_s, 4, 1e-3, 1e4) \
  OPTION(FoamCrestFrom, Foam, crest_from_per_m, 0, 0, 1e6)          \
  OPTION(FoamCrestSpan, Foam, crest_span_per_m, 0.25, 1e-6, 1e6)    \
  OPTION(FoamCrestWeight, Foam, crest_weight, 1.5, 0, 1e3)          \
  OPTION(FoamLength, Foam, length_m, 0, 0, 1e3)                     \
  OPTION(FoamEnergyFrom, Foam, energy_from_j_kg, 5, 0, 1e6)         \
  OPTION(FoamEnergySpan, Foam, energy_span_j_kg, 15, 1e-6, 1e6)     \
  OPTION(FoamLifetime, Foam, lifetime_s, 3, 0.01, 1e4)              \
  OPTION(FoamDiameter, Foam, diameter_m, 0.05, 1e-5, 1)             \
  OPTION(FoamAirDrag, Foam, air_drag_per_s, 0.5, 0, 1e3)            \
  OPTION(FoamRise, Foam, rise_m_s, 0.3, 1e-3, 10)                   \
  OPTION(FoamMost, Foam, most_particles, 65536, 1, 1048576)         \
  OPTION(FoamCoarsest, Foam, coarsest_level, 3, 0, 3)

enum class EffectOption {
#define SIM_ENUMERATOR(Name, ...) Name,
  SIM_EFFECT_OPTIONS(SIM_ENUMERATOR)
#undef SIM_ENUMERATOR
      count
};
inline constexpr std::size_t option_count = static_cast<std::size_t>(EffectOption::count);
/// One value per row of the options. An Effect uses the values of its own options only.
using EffectOptions = std::array<double, option_count>;
inline constexpr EffectOptions usual_options{
#define SIM_VALUE(Name, effect, key, usual, ...) usual,
    SIM_EFFECT_OPTIONS(SIM_VALUE)
#undef SIM_VALUE
};

/// One option: the effect that it belongs to, its key, default and range.
struct OptionTraits {
  EffectKind of;
  const char* key;
  double usual, least, most;
};
const OptionTraits& traits_of(EffectOption option);

/// The option coarsest_level that limits the levels on which an effect acts: of the effect itself or, if it
/// has none, of the effect that it needs. None if neither effect has the option.
std::optional<EffectOption> coarsest_level_of(EffectKind kind);

/// One row of the registry SIM_EFFECTS: the properties of an effect.
struct EffectTraits {
  const char* word;
  const char* key;  ///< key of the coefficient; ends in the unit
  EffectUnit unit;
  double longest_step;
  EffectKind needs;
  const char* source;
};
const EffectTraits& traits_of(EffectKind kind);

/// An effect as listed by a scene. The coefficient and the options have the SI units that end their keys.
struct Effect {
  EffectKind kind{};
  double coefficient = 0;  ///< >= 0; 0 drops the effect
  EffectOptions options = usual_options;

  friend bool operator==(const Effect&, const Effect&) = default;
};
/// One " key = value" per option of the effect's kind, for records and people; empty without options.
std::string options_in_words(const Effect& effect);

/// Coefficient of each effect, 0 if it is not listed, and the options of the effects.
struct EffectCoefficients {
  std::array<float, effect_count> values{};
  EffectOptions options = usual_options;
  float operator[](EffectKind kind) const { return values[static_cast<std::size_t>(kind)]; }
  float operator[](EffectOption option) const {
    return static_cast<float>(options[static_cast<std::size_t>(option)]);
  }
};
EffectCoefficients coefficients_of(const std::vector<Effect>& effects);

/// True if the effect acts on no water of finest_level or coarser, because its coarsest_level is finer than
/// finest_level. `among`: all effects of the scene, which include the effect that provides its
/// coarsest_level.
bool is_idle(const Effect& effect, const std::vector<Effect>& among, int finest_level);
/// The effects that are not idle in water of finest_level and coarser.
std::vector<Effect> acting_effects(const std::vector<Effect>& effects, int finest_level);

/// Reads the tables [[effect]] of a scene file of format 2, except picture effects (picture_effects.hpp).
/// Errors are base::Error at file:line:column, for example: unknown, listed twice, missing an effect that it
/// needs, out of range, an option that must be whole and is not, or a program built without effects. kept:
/// effects already listed; the result begins with them.
std::vector<Effect> read_effects(const std::vector<base::TomlTable>& tables,
                                 const std::vector<Effect>& kept = {});
/// The effect kind that a word of a scene file names; none for an unknown word.
std::optional<EffectKind> effect_named(const std::string& word);
/// Writes tables that read_effects() reads back as the same effects; omits effects with the coefficient 0.
std::string format_effects(const std::vector<Effect>& effects);
/// "foam emission_per_s = 0.3 lifetime_s = 4 ...; air_drag ...", for records and people; empty: no effects.
std::string effects_in_words(const std::vector<Effect>& effects);
/// The checks of read_effects() for a scene that was not read from a file, except the check for whole
/// numbers; base::Error names the effect.
void check_effects(const std::vector<Effect>& effects);

/// The longest substep for which every effect is stable, and the effect that limits it.
struct EffectStep {
  double seconds = std::numeric_limits<double>::infinity();
  EffectKind of = no_effect;
};
EffectStep longest_step(const std::vector<Effect>& effects, double finest_spacing_m);
/// Maximum speed that surface tension can give water, m/s: sqrt(12 sigma / (rho_0 d)), at which the kinetic
/// energy of a cube of side d equals its surface energy. sigma: sum of the coefficients in N/m; 0 without
/// any.
double capillary_speed(const std::vector<Effect>& effects, double finest_spacing_m);

/// True if built with -DVIP_EFFECTS=ON.
bool has_effects();

}  // namespace sim
