#include "libsim/setting/solver_setting.hpp"

#include <fmt/core.h>
#include <cmath>
#include <limits>

#include "libsim/solver/settled_state.hpp"

namespace sim {

const std::array<SolverKnobTraits, solver_knob_count>& solver_knobs() {
  using enum SolverKnob;
  static const auto tuned = readings_of(Preset::Tuned);
  static const std::array<SolverKnobTraits, solver_knob_count> all{{
      {.knob = Size,
       .column = "n_star",
       .words = "n_*",
       .least = 1,
       .most = 1e9,
       .whole = true,
       .usual = 32768,
       .others = {0.25, 0.5, 2}},
      {.knob = Rate,
       .column = "frames_per_s",
       .words = "frames/s",
       .least = 1,
       .most = 1e5,
       .usual = 60,
       .others = {90, 120}},
      {.knob = Iterations,
       .column = "iterations",
       .words = "projections",
       .least = 1,
       .most = 64,
       .whole = true,
       .usual = 4,
       .others = {2, 8, 16}},
      {.knob = Substeps,
       .column = "substeps",
       .words = "substeps",
       .least = 0,
       .most = 64,
       .whole = true,
       .usual = 0,
       .others = {1, 2, 4}},
      {.knob = CoarseCycles,
       .column = "coarse_cycles",
       .words = "coarse cycles",
       .least = 0,
       .most = 16,
       .whole = true,
       .usual = 2,
       .others = {0, 1, 4}},
      {.knob = Momentum,
       .column = "momentum",
       .words = "momentum",
       .least = 0,
       .most = 100,
       .usual = 0.4,
       .others = {0, 0.2, 0.6}},
      {.knob = Levels,
       .column = "levels",
       .words = "levels",
       .of_levels = true,
       .least = 1,
       .most = 4,
       .whole = true,
       .usual = 4,
       .others = {2, 3}},
      {.knob = Alpha,
       .column = "alpha",
       .words = "alpha",
       .of_levels = true,
       .of_saliency = true,
       .least = 0,
       .most = 1,
       .usual = tuned.alpha,
       .others = {0, 1.0 / 3, 1}},
      {.knob = Fovea,
       .column = "fovea_deg",
       .words = "fovea, deg",
       .of_levels = true,
       .least = 0,
       .most = 180,
       .usual = tuned.fovea_half_angle_deg,
       .others = {5, 15, 30}},
      {.knob = Beta,
       .column = "beta",
       .words = "beta",
       .of_levels = true,
       .least = 1e-6,
       .most = 1,
       .usual = 1,
       .others = {0.9, 0.67, 0.5}},
  }};
  return all;
}

const SolverKnobTraits& traits_of(SolverKnob knob) { return solver_knobs()[static_cast<std::size_t>(knob)]; }

SolverSetting usual_setting(const std::string& scene, MethodKind method, std::int64_t n_star) {
  SolverSetting out{.scene = scene, .method = method};
  for (const auto& traits : solver_knobs()) out[traits.knob] = traits.usual;
  out[SolverKnob::Size] = static_cast<double>(n_star);
  return out;
}

bool turns(SolverKnob knob, MethodKind method) {
  const auto& method_traits = traits_of(method);
  const auto& traits = traits_of(knob);
  if (traits.of_saliency) return method_traits.target == TargetSource::Saliency;
  return !traits.of_levels || method_traits.adaptive();
}

std::string value_words(SolverKnob knob, double value) {
  return traits_of(knob).whole ? fmt::format("{:.0f}", value) : fmt::format("{:.6g}", value);
}

std::string to_text(const SolverSetting& setting) {
  std::string out = setting.scene + " " + method_name(setting.method);
  for (const auto& traits : solver_knobs()) {
    if (turns(traits.knob, setting.method))
      out += fmt::format(" {}={}", traits.column, value_words(traits.knob, setting[traits.knob]));
  }
  return out;
}

SolverSetting setting_of(const Scene& scene, const SimulationOptions& options) {
  using enum SolverKnob;
  SolverSetting out = usual_setting(scene.name, options.method, options.n_star);
  out[Rate] = 1 / (options.frame_dt_s > 0 ? options.frame_dt_s : scene.frame_dt_s);
  out[Iterations] = options.iterations > 0 ? options.iterations : scene.solver_iterations;
  out[Substeps] = options.substeps;
  if (options.coarse_cycles >= 0) out[CoarseCycles] = options.coarse_cycles;
  if (options.momentum >= 0) out[Momentum] = options.momentum;
  out[Levels] = options.levels;
  out[Alpha] = options.readings.alpha;
  out[Fovea] = options.readings.fovea_half_angle_deg;
  const auto& temporal = options.temporal;
  if (!temporal.always && !traits_of(options.method).temporal) return out;
  out[Beta] = temporal.fixed_tau ? stats::activation_floor(temporal.model, *temporal.fixed_tau)
                                 : std::numeric_limits<double>::quiet_NaN();
  return out;
}

SimulationOptions to_options(const SolverSetting& setting, Backend backend, std::uint32_t seed) {
  using enum SolverKnob;
  SimulationOptions out;
  out.method = setting.method;
  out.n_star = std::llround(setting[Size]);
  out.backend = backend;
  out.cache = default_cache_folder();
  out.frame_dt_s = 1 / setting[Rate];
  out.iterations = static_cast<int>(setting[Iterations]);
  out.substeps = static_cast<int>(setting[Substeps]);
  out.coarse_cycles = static_cast<int>(setting[CoarseCycles]);
  out.momentum = setting[Momentum];
  if (!traits_of(setting.method).adaptive()) return out;
  out.levels = static_cast<int>(setting[Levels]);
  out.readings.alpha = setting[Alpha];
  out.readings.fovea_half_angle_deg = setting[Fovea];
  out.temporal.seed = seed;
  out.temporal.always = setting[Beta] < 1;
  if (out.temporal.always || traits_of(setting.method).temporal)
    out.temporal.fixed_tau = std::log(setting[Beta]) / (2 * out.temporal.model.b);
  return out;
}

}  // namespace sim
