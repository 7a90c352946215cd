#include "apps/study/cell_stimuli.hpp"

#include <set>

#include "libstudy/display/null.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

std::string instead(const std::string& what, const std::string& shown, const std::string& wanted) {
  return shown == wanted ? "" : what + " " + shown + " instead of " + wanted;
}

std::string departure_of(const std::filesystem::path& path, const study::StimulusSpec& what) {
  const sim::BakeReader bake(path);
  const sim::BakeHeader& header = bake.header();
  const sim::Scene scene = sim::read_scene(base::find_input(what.scene));
  std::string all;
  for (const std::string& one :
       {instead("scene", header.scene_name + " " + header.scene_sha256.substr(0, 12),
                scene.name + " " + scene.sha256.substr(0, 12)),
        instead("method", header.method, sim::method_name(sim::parse_method(what.method))),
        instead("n_*", std::to_string(header.n_star), std::to_string(sim::parse_n_star(what.n_star)))}) {
    if (!one.empty()) all += (all.empty() ? "" : ", ") + one;
  }
  return all;
}

/// One bake stands for every cell, so all cells must show one thing.
const study::StimulusSpec& only_stimulus(const study::Protocol& protocol, const std::string& bake) {
  const auto& cells = protocol.design.cells;
  for (const study::Cell& cell : cells) {
    if (cell.stimulus == cells.front().stimulus) continue;
    throw base::Error("--stimulus " + bake, "shows one scene, method and n_*, but the protocol names several",
                      "run such a protocol live, or use it with one of each");
  }
  return cells.front().stimulus;
}

/// Before anybody sits down, not when the cell's turn comes.
void check_words(const study::Protocol& protocol) {
  for (const study::Cell& cell : protocol.design.cells) {
    sim::parse_method(cell.stimulus.method);
    sim::parse_n_star(cell.stimulus.n_star);
  }
}

std::string describe_live(const study::Protocol& protocol, const std::string& backend) {
  std::string text = "live on " + sim::backend_name(sim::choose_backend(backend));
  std::set<std::string> scenes;
  for (const study::Cell& cell : protocol.design.cells) {
    if (!scenes.insert(cell.stimulus.scene).second) continue;
    const sim::Scene scene = sim::read_scene(base::find_input(cell.stimulus.scene));
    text += (scenes.size() > 1 ? "; " : ", scene ") + scene.name + " " + scene.sha256;
  }
  return text;
}

}  // namespace

CellStimuli::CellStimuli(const RunOptions& options, const study::Protocol& protocol,
                         const stats::PtpeModel& model, Viewing viewing)
    : options_(options) {
  choice_.bake = options.bake;
  choice_.content_step_s = protocol.content.content_step_s;
  choice_.backend = options.backend;
  choice_.model = model;
  choice_.viewing = std::move(viewing);
  if (!options.bake.empty()) {
    departure_ = departure_of(options.bake, only_stimulus(protocol, options.bake));
    stimulus_ = make_stimulus(choice_);
  } else if (options.display == "none") {
    stimulus_ = std::make_unique<study::NullStimulus>(protocol.content.content_step_s);
  } else {
    check_words(protocol);
    live_ = true;
  }
  description_ = live_ ? describe_live(protocol, options.backend) : stimulus_->description();
}

StimulusChoice CellStimuli::choice_of(const study::Cell& cell) const {
  StimulusChoice choice = choice_;
  choice.scene = base::find_input(cell.stimulus.scene);
  choice.method = cell.stimulus.method;
  choice.n_star = cell.stimulus.n_star;
  const bool paced = cell.setting.mean > 0;
  if (paced) choice.fixed_rate = sim::FrameRate{cell.setting.mean, cell.setting.sd};
  return choice;
}

study::Stimulus& CellStimuli::stimulus(const study::Cell& cell) {
  if (!live_) return *stimulus_;
  const StimulusChoice choice = choice_of(cell);
  Made wanted{cell.stimulus, {}};
  if (sim::traits_of(sim::parse_method(choice.method)).temporal) wanted.rate = choice.fixed_rate;
  if (made_ != wanted) {
    made_.reset();
    stimulus_.reset();
    stimulus_ = make_stimulus(choice);
    made_ = wanted;
  }
  return *stimulus_;
}

}  // namespace apps
