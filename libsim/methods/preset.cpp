#include "libsim/methods/preset.hpp"

#include <algorithm>
#include <cctype>

#include "stats/base/error.hpp"

namespace sim {

Preset parse_preset(std::string_view name) {
  std::string word(name);
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (word == "paper") return Preset::Paper;
  if (word == "tuned") return Preset::Tuned;
  throw base::Error("preset \"" + std::string(name) + "\"", "is not known", "use paper or tuned");
}

std::string preset_name(Preset preset) { return preset == Preset::Paper ? "paper" : "tuned"; }

Readings readings_of(Preset preset) {
  Readings out;
  if (preset == Preset::Tuned) return out;
  out.thickness = ThicknessWeight::Max;
  out.gradient = GradientReach::TwoSupports;
  out.temporal_follow = 1;
  out.temporal_period_frames = 1;
  out.levels_period_frames = 1;
  out.calm_out_of_view = false;
  out.dimensionless = false;
  out.normalisation = Normalisation::MinMax;
  out.calm_speed = 0;
  out.saliency_floor = 0;
  out.drop_density = 0;
  out.graded_targets = false;
  std::fill_n(out.split_offset, 3, 0.794);
  out.split_share = 1;
  out.merge_same_target = true;
  out.merge_reach = 2;
  out.merge_overlap = 1;
  out.merge_keeps_steps = false;
  out.merge_dead_band = 0;
  out.calm_dead_band = 0;
  out.dimensionless_levels = false;
  out.rest_within_frame = false;
  out.inactive_yield = false;
  return out;
}

}  // namespace sim
