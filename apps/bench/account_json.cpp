#include "apps/bench/account_json.hpp"

namespace apps {

base::Json account_json(std::int64_t frame, const study::FrameFacts& facts) {
  base::Json out{{"frame", frame}, {"particles", facts.particles_by_level}};
  const auto t = facts.tolerance.value_or(study::FrameTolerance{});
  const bool known = facts.tolerance.has_value();
  out["active_fraction"] = known ? base::Json(t.active_fraction) : base::Json();
  out["tau_fps"] = t.tau_fps;
  out["beta"] = known ? base::Json(t.beta) : base::Json();
  out["mu_fps"] = t.mu_fps;
  out["delta_fps"] = t.delta_fps;
  if (const auto& met = facts.guards) {
    out["guards"] = {{"speed_limited", met->speed_limited},
                     {"coincident_pairs", met->coincident_pairs},
                     {"not_finite", met->not_finite},
                     {"neighbours_dropped", met->neighbours_dropped},
                     {"wall_projected", met->wall_projected},
                     {"nozzle_waited", met->nozzle_waited},
                     {"saliency_not_finite", met->saliency_not_finite},
                     {"gaze_lost", met->gaze_lost}};
  }
  return out;
}

base::Json divergence_json(const std::optional<sim::Divergence>& divergence) {
  if (!divergence) return {};
  base::Json out{{"frame", divergence->frame},
                 {"particle", divergence->particle},
                 {"cause", sim::in_words(divergence->cause)},
                 {"count", divergence->count},
                 {"in_words", sim::in_words(*divergence)}};
  if (const auto& at = divergence->where_m) out["where_m"] = *at;
  return out;
}

}  // namespace apps
