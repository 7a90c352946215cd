#include "libstudy/stimulus/bakes/bake_plan.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <filesystem>

#include "libsim/bake/layout.hpp"
#include "libsim/methods/method.hpp"
#include "libstudy/check/rehearsal.hpp"
#include "libstudy/stimulus/bakes/cell_effects.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace {

bool same_rate(const FpsSetting& a, const FpsSetting& b) { return a.mean == b.mean && a.sd == b.sd; }

std::int64_t frames_of(const Protocol& protocol, const Cell& cell) {
  return protocol.content.start_frame + content_steps(protocol, cell.setting, 0);
}

std::string why_live(const Protocol& protocol, const PlannedStimulus& one) {
  if (protocol.design.timing == TimingSource::Native) return "as fast as it runs";
  if (one.adaptive && !protocol.fixation) return "it follows the gaze";
  if (one.frames > sim::bake::max_frames)
    return "a bake holds " + std::to_string(sim::bake::max_frames) + " frames at most";
  return "";
}

/// Name such as "single_dam_32k_HiRes.bake". Also contains the level of effects, the surface, and the frame
/// rate for tau, if the stimulus has them.
std::string file_name(const PlannedStimulus& one) {
  std::string out =
      std::filesystem::path(one.what.scene).stem().string() + "_" + one.what.n_star + "_" + one.what.method;
  for (const std::string* level : {&one.what.effects, &one.what.surface})
    if (!level->empty()) out += "_" + *level;
  if (one.rate) out += fmt::format("_{:.6g}_{:.6g}", one.rate->mean, one.rate->sd);
  return out + ".bake";
}

/// Appends numbers to equal file names. Names are equal for scenes of the same name in two folders, and for
/// frame rates that round to the same text.
void make_distinct(std::vector<PlannedStimulus>& all) {
  for (auto one = all.begin(); one != all.end(); ++one) {
    if (one->file.empty()) continue;
    const std::string stem = std::filesystem::path(one->file).stem().string();
    for (int n = 2; std::any_of(all.begin(), one, [&](const auto& had) { return had.file == one->file; });
         ++n)
      one->file = stem + "-" + std::to_string(n) + ".bake";
  }
}

}  // namespace

std::vector<PlannedStimulus> plan_bakes(const Protocol& protocol) {
  std::vector<PlannedStimulus> out;
  const bool native = protocol.design.timing == TimingSource::Native;
  for (std::size_t i = 0; i < protocol.design.cells.size(); ++i) {
    const Cell& cell = protocol.design.cells[i];
    const sim::MethodTraits& traits = sim::traits_of(sim::parse_method(cell.stimulus.method));
    sim::parse_n_star(cell.stimulus.n_star);
    const bool by_rate = traits.temporal && !native;
    auto known = std::find_if(out.begin(), out.end(), [&](const PlannedStimulus& one) {
      return one.what == cell.stimulus && (!by_rate || same_rate(*one.rate, cell.setting));
    });
    if (known == out.end()) {
      known = out.emplace(out.end());
      known->what = cell.stimulus;
      known->adaptive = traits.adaptive();
      if (by_rate) known->rate = cell.setting;
    }
    known->cells.push_back(static_cast<int>(i));
    if (!native) known->frames = std::max(known->frames, frames_of(protocol, cell));
  }
  for (PlannedStimulus& one : out) {
    one.live = why_live(protocol, one);
    if (one.live.empty()) one.file = file_name(one);
  }
  make_distinct(out);
  return out;
}

BakeOrder order_of(const Protocol& protocol, const PlannedStimulus& one, const SessionLook& look) {
  BakeOrder order;
  order.fluid = look.common;
  order.fluid.viewing.gaze = {};  // an empty gaze is the middle of the picture
  order.fluid.scene = base::find_input(one.what.scene);
  order.fluid.method = one.what.method;
  order.fluid.n_star = one.what.n_star;
  const CellEffects effects = cell_effects(protocol, one.what);
  order.fluid.effects = effects.water;
  order.fluid.picture_effects = effects.picture;
  order.fluid.paint_temperature = protocol.design.paint_temperature;
  order.fluid.surface = one.what.surface;
  order.fluid.content_step_s = protocol.content.content_step_s;
  if (one.rate) order.fluid.fixed_rate = sim::FrameRate{one.rate->mean, one.rate->sd};
  order.frames = one.frames;
  order.size = look.size;
  return order;
}

}  // namespace study
