#include "libstudy/sweep/matrix.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "stats/base/file.hpp"

namespace study {

namespace {

sim::SolverSetting start_of(const SweepPlan& plan, sim::MethodKind method) {
  auto out = sim::usual_setting(plan.scene, method, plan.n_star);
  // Beta, the lowest probability with which temporal acceleration solves a particle, is fixed at its value
  // for tau = -6 frames/s (frame rate minus the rate that just satisfies), as in the paper's Table 2.
  if (sim::traits_of(method).temporal) out[sim::SolverKnob::Beta] = stats::activation_floor({}, -6);
  return out;
}

/// Converts an entry of SolverKnobTraits::others (values to try besides the usual one) to the knob's value:
/// for Size the entry is a multiple of the plan's n_star.
double value_of(const sim::SolverKnobTraits& traits, double value, const SweepPlan& plan) {
  return traits.knob == sim::SolverKnob::Size ? std::round(value * static_cast<double>(plan.n_star)) : value;
}

std::vector<sim::SolverSetting> methods_by_size(const SweepPlan& plan) {
  std::vector<sim::SolverSetting> out;
  for (const auto& method : sim::all_methods()) {
    out.push_back(start_of(plan, method.kind));
    if (plan.quick) continue;
    for (const double factor : sim::traits_of(sim::SolverKnob::Size).others) {
      out.push_back(start_of(plan, method.kind));
      out.back()[sim::SolverKnob::Size] = value_of(sim::traits_of(sim::SolverKnob::Size), factor, plan);
    }
  }
  return out;
}

std::vector<sim::SolverSetting> one_at_a_time(const SweepPlan& plan, sim::MethodKind method) {
  std::vector<sim::SolverSetting> out;
  for (const auto& traits : sim::solver_knobs()) {
    if (!sim::turns(traits.knob, method)) continue;
    if (plan.quick && traits.knob != sim::SolverKnob::Iterations) continue;
    for (const double value : traits.others) {
      out.push_back(start_of(plan, method));
      out.back()[traits.knob] = value_of(traits, value, plan);
    }
  }
  return out;
}

std::vector<sim::SolverSetting> quarter_factorial(const SweepPlan& plan) {
  constexpr double sizes[] = {0.25, 0.5, 1, 2}, iterations[] = {2, 4, 8}, substeps[] = {1, 2, 4},
                   levels[] = {1, 2, 3, 4};
  std::vector<sim::SolverSetting> out;
  for (std::size_t s = 0; s < 4; ++s) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t u = 0; u < 3; ++u) {
        auto& setting = out.emplace_back(start_of(plan, sim::MethodKind::Ours));
        setting[sim::SolverKnob::Size] = value_of(sim::traits_of(sim::SolverKnob::Size), sizes[s], plan);
        setting[sim::SolverKnob::Iterations] = iterations[i];
        setting[sim::SolverKnob::Substeps] = substeps[u];
        setting[sim::SolverKnob::Levels] = levels[(s + i + u) % 4];
      }
    }
  }
  return out;
}

}  // namespace

std::string to_text(const SweepCell& cell) {
  const auto named = [](const std::string& size) { return size.empty() ? "none" : size; };
  return fmt::format("{} seed={} seconds={:.6g} picture={} kept={}", sim::to_text(cell.setting), cell.seed,
                     cell.seconds, named(cell.size), named(cell.kept));
}

std::string key_of(const SweepCell& cell, const std::string& scene_sha256, const std::string& program) {
  return base::sha256_hex(to_text(cell) + "\n" + scene_sha256 + "\n" + program).substr(0, 16);
}

sim::SolverSetting reference_setting(const std::string& scene, std::int64_t n_star) {
  auto out = sim::usual_setting(scene, sim::MethodKind::HiRes, n_star);
  out[sim::SolverKnob::Iterations] = 32;
  out[sim::SolverKnob::Substeps] = 4;
  return out;
}

std::vector<sim::SolverSetting> finer_references(const sim::SolverSetting& reference) {
  std::vector<sim::SolverSetting> out;
  for (const sim::SolverKnob knob :
       {sim::SolverKnob::Iterations, sim::SolverKnob::Substeps, sim::SolverKnob::Size}) {
    out.push_back(reference);
    out.back()[knob] *= 2;
  }
  return out;
}

std::vector<SweepCell> cells_of(const SweepPlan& plan) {
  std::vector<SweepCell> out;
  const auto add = [&](const sim::SolverSetting& setting, int seeds) {
    for (int seed = 1; seed <= seeds; ++seed) {
      const SweepCell cell{setting, seed, plan.seconds, plan.size, plan.kept};
      if (std::find(out.begin(), out.end(), cell) == out.end()) out.push_back(cell);
    }
  };
  const auto reference = reference_setting(plan.scene, plan.n_star);
  add(reference, 2);
  if (!plan.quick)
    for (const auto& finer : finer_references(reference)) add(finer, 1);
  for (const auto& setting : methods_by_size(plan)) add(setting, plan.seeds);
  for (const auto method : {sim::MethodKind::HiRes, sim::MethodKind::Ours})
    for (const auto& setting : one_at_a_time(plan, method)) add(setting, plan.seeds);
  if (!plan.quick)
    for (const auto& setting : quarter_factorial(plan)) add(setting, plan.seeds);
  return out;
}

}  // namespace study
