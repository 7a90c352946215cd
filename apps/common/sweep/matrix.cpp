#include "apps/common/sweep/matrix.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>

#include "stats/base/file.hpp"

namespace apps {

namespace {

SolverSetting start_of(const SweepPlan& plan, sim::MethodKind method) {
  auto out = usual_setting(plan.scene, method, plan.n_star);
  // At tau = -6 frames/s, as in Table 2.
  if (sim::traits_of(method).temporal) out[SolverKnob::Beta] = stats::activation_floor({}, -6);
  return out;
}

/// A knob's value in a setting.
double value_of(const SolverKnobTraits& traits, double value, const SweepPlan& plan) {
  return traits.knob == SolverKnob::Size ? std::round(value * static_cast<double>(plan.n_star)) : value;
}

std::vector<SolverSetting> methods_by_size(const SweepPlan& plan) {
  std::vector<SolverSetting> out;
  for (const auto& method : sim::all_methods()) {
    out.push_back(start_of(plan, method.kind));
    if (plan.quick) continue;
    for (const double factor : traits_of(SolverKnob::Size).others) {
      out.push_back(start_of(plan, method.kind));
      out.back()[SolverKnob::Size] = value_of(traits_of(SolverKnob::Size), factor, plan);
    }
  }
  return out;
}

std::vector<SolverSetting> one_at_a_time(const SweepPlan& plan, sim::MethodKind method) {
  std::vector<SolverSetting> out;
  for (const auto& traits : solver_knobs()) {
    if (!turns(traits.knob, method)) continue;
    if (plan.quick && traits.knob != SolverKnob::Iterations) continue;
    for (const double value : traits.others) {
      out.push_back(start_of(plan, method));
      out.back()[traits.knob] = value_of(traits, value, plan);
    }
  }
  return out;
}

std::vector<SolverSetting> quarter_factorial(const SweepPlan& plan) {
  constexpr double sizes[] = {0.25, 0.5, 1, 2}, iterations[] = {2, 4, 8}, substeps[] = {1, 2, 4},
                   levels[] = {1, 2, 3, 4};
  std::vector<SolverSetting> out;
  for (std::size_t s = 0; s < 4; ++s) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t u = 0; u < 3; ++u) {
        auto& setting = out.emplace_back(start_of(plan, sim::MethodKind::Ours));
        setting[SolverKnob::Size] = value_of(traits_of(SolverKnob::Size), sizes[s], plan);
        setting[SolverKnob::Iterations] = iterations[i];
        setting[SolverKnob::Substeps] = substeps[u];
        setting[SolverKnob::Levels] = levels[(s + i + u) % 4];
      }
    }
  }
  return out;
}

}  // namespace

std::string to_text(const SweepCell& cell) {
  const auto named = [](const std::string& size) { return size.empty() ? "none" : size; };
  return fmt::format("{} seed={} seconds={:.6g} picture={} kept={}", to_text(cell.setting), cell.seed,
                     cell.seconds, named(cell.size), named(cell.kept));
}

std::string key_of(const SweepCell& cell, const std::string& scene_sha256, const std::string& program) {
  return base::sha256_hex(to_text(cell) + "\n" + scene_sha256 + "\n" + program).substr(0, 16);
}

SolverSetting reference_setting(const std::string& scene, std::int64_t n_star) {
  auto out = usual_setting(scene, sim::MethodKind::HiRes, n_star);
  out[SolverKnob::Iterations] = 32;
  out[SolverKnob::Substeps] = 4;
  return out;
}

std::vector<SolverSetting> finer_references(const SolverSetting& reference) {
  std::vector<SolverSetting> out;
  for (const SolverKnob knob : {SolverKnob::Iterations, SolverKnob::Substeps, SolverKnob::Size}) {
    out.push_back(reference);
    out.back()[knob] *= 2;
  }
  return out;
}

std::vector<SweepCell> cells_of(const SweepPlan& plan) {
  std::vector<SweepCell> out;
  const auto add = [&](const SolverSetting& setting, int seeds) {
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

}  // namespace apps
