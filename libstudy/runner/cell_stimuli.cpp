#include "libstudy/runner/cell_stimuli.hpp"

#include "libstudy/stimulus/bakes/cell_effects.hpp"

#include <set>

#include "libsim/scene/extent.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libstudy/display/null.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

/// Checks the names of methods, n_* and effects before the session begins, so that a wrong name does not stop
/// the session at a trial.
void check_words(const Protocol& protocol) {
  for (const Cell& cell : protocol.design.cells) {
    sim::parse_method(cell.stimulus.method);
    sim::parse_n_star(cell.stimulus.n_star);
  }
  check_cell_effects(protocol);
}

std::string describe_live(const Protocol& protocol, const std::string& backend) {
  std::string text = "live on " + sim::backend_name(sim::choose_backend(backend));
  std::set<std::string> scenes;
  for (const Cell& cell : protocol.design.cells) {
    if (!scenes.insert(cell.stimulus.scene).second) continue;
    const sim::Scene scene = sim::read_scene(base::find_input(cell.stimulus.scene));
    text += (scenes.size() > 1 ? "; " : ", scene ") + scene.name + " " + scene.sha256;
    if (!protocol.design.effects.empty()) text += ", effects " + levels_in_words(protocol, scene);
    if (protocol.design.paint_temperature) text += ", painted " + temperatures_in_words(protocol, scene);
  }
  std::set<std::string> surfaces;
  for (const Cell& cell : protocol.design.cells)
    if (!cell.stimulus.surface.empty()) surfaces.insert(cell.stimulus.surface);
  if (!surfaces.empty()) text += ", drawn as " + base::joined({surfaces.begin(), surfaces.end()});
  return text;
}

}  // namespace

CellStimuli::CellStimuli(const RunOptions& options, const Protocol& protocol, const stats::PtpeModel& model,
                         Viewing viewing, SessionBakes bakes, SessionSettings settings)
    : protocol_(protocol),
      bakes_(std::move(bakes)),
      settings_(std::move(settings)),
      shown_(options.display != "none"),
      with_patch_(options.light_patch) {
  choice_.content_step_s = protocol.content.content_step_s;
  choice_.paint_temperature = protocol.design.paint_temperature;
  choice_.backend = options.backend;
  choice_.model = model;
  choice_.viewing = std::move(viewing);
  if (shown_) check_words(protocol);
  for (const Cell& cell : protocol.design.cells)
    if (is_live(cell))
      sim::check_ways(sim::read_scene(base::find_input(cell.stimulus.scene)),
                      sim::parse_n_star(cell.stimulus.n_star));
  check_settings_live(protocol);
  description_ = describe(protocol) + (with_patch_ ? ", with a light patch" : "");
}

/// Refuses a solver setting for a cell that is not computed live: a bake contains its setting, and --display
/// none computes nothing.
void CellStimuli::check_settings_live(const Protocol& protocol) const {
  for (const Cell& cell : protocol.design.cells) {
    const sim::SettingFile* setting = settings_.empty() ? nullptr : settings_.of(cell.stimulus);
    if (!setting || is_live(cell)) continue;
    const std::string who = cell.stimulus.method + " at n_* " + cell.stimulus.n_star;
    if (!shown_)
      throw base::Error("--setting", "is for live fluid, and with --display none nothing is computed",
                        "leave it out, or use --display headless");
    throw base::Error("--setting",
                      "is for " + who + ", which is played from " + bakes_.of(cell)->path.string() +
                          ": a bake holds the setting that it was computed at",
                      "leave the setting or that bake out");
  }
}

/// Describes the stimuli of all cells: first the bakes, then the live fluid with its solver settings. Without
/// bakes and live fluid, returns the description of the empty stimulus. With bakes alone, mentions painted
/// temperatures at the end.
std::string CellStimuli::describe(const Protocol& protocol) {
  const bool live = shown_ && !bakes_.whole();
  const std::string bakes = bakes_.description();
  const auto live_words = [&] { return describe_live(protocol, choice_.backend) + settings_.description(); };
  if (bakes.empty() && live) return live_words();
  if (bakes.empty()) return stimulus(protocol.design.cells.front()).description();
  if (live) return bakes + "; " + live_words();
  return bakes + (choice_.paint_temperature ? "; painted temperature" : "");
}

StimulusChoice CellStimuli::choice_of(const Cell& cell) const {
  StimulusChoice choice = choice_;
  choice.scene = base::find_input(cell.stimulus.scene);
  choice.method = cell.stimulus.method;
  choice.n_star = cell.stimulus.n_star;
  choice.surface = cell.stimulus.surface;
  const CellEffects effects = cell_effects(protocol_, cell.stimulus);
  choice.effects = effects.water;
  choice.picture_effects = effects.picture;
  const sim::SettingFile* setting = settings_.of(cell.stimulus);
  if (setting) choice.setting = setting->setting;
  const bool paced = cell.setting.mean > 0 && !setting;
  if (paced) choice.fixed_rate = sim::FrameRate{cell.setting.mean, cell.setting.sd};
  return choice;
}

CellStimuli::Made CellStimuli::wanted_for(const Cell& cell) const {
  if (const FoundBake* bake = bakes_.of(cell)) {
    Made wanted{{}, {}, bake->path};
    wanted.what.surface = cell.stimulus.surface;
    return wanted;
  }
  if (!shown_) return {};
  Made wanted{cell.stimulus, {}, {}};
  const bool by_rate = sim::traits_of(sim::parse_method(cell.stimulus.method)).temporal;
  if (by_rate) wanted.rate = choice_of(cell).fixed_rate;
  return wanted;
}

std::unique_ptr<Stimulus> CellStimuli::make(const Cell& cell, const Made& wanted) const {
  if (wanted == Made{}) return std::make_unique<NullStimulus>(choice_.content_step_s);
  if (wanted.bake.empty()) return make_stimulus(choice_of(cell));
  StimulusChoice choice = choice_;
  choice.bake = wanted.bake;
  choice.surface = wanted.what.surface;
  return make_stimulus(choice);
}

sim::GuardCounts CellStimuli::guards() const {
  const auto* live = dynamic_cast<const LiveFluid*>(stimulus_.get());
  return live ? sim::sum(former_guards_, live->guards()) : former_guards_;
}

Stimulus& CellStimuli::stimulus(const Cell& cell) {
  const Made wanted = wanted_for(cell);
  if (made_ != wanted) {
    made_.reset();
    former_guards_ = guards();
    patch_.reset();
    stimulus_.reset();
    stimulus_ = make(cell, wanted);
    if (with_patch_) patch_ = std::make_unique<LightPatch>(*stimulus_);
    made_ = wanted;
  }
  if (!patch_) return *stimulus_;
  patch_->begin_showing();
  return *patch_;
}

}  // namespace study
