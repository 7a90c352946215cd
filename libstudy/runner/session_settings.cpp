#include "libstudy/runner/session_settings.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <set>

#include "libsim/methods/method.hpp"
#include "libsim/scene/scene.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace {

bool is_for(const sim::SolverSetting& setting, const StimulusSpec& stimulus) {
  return sim::parse_method(stimulus.method) == setting.method &&
         sim::parse_n_star(stimulus.n_star) == std::llround(setting[sim::SolverKnob::Size]);
}

std::string named(const sim::SolverSetting& setting) {
  return fmt::format("{} at n_* {}", sim::method_name(setting.method),
                     sim::value_words(sim::SolverKnob::Size, setting[sim::SolverKnob::Size]));
}

void check_shown(const sim::SolverSetting& setting, const Protocol& protocol, const std::string& place) {
  const auto& cells = protocol.design.cells;
  const bool shown = std::any_of(cells.begin(), cells.end(),
                                 [&](const Cell& cell) { return is_for(setting, cell.stimulus); });
  if (shown) return;
  throw base::Error(
      place,
      "is a setting of " + named(setting) + ", which no cell of protocol '" + protocol.name + "' shows",
      "choose a setting for a method and n_* of the protocol (vip-bench accuracy --budget … --of-method, "
      "--of-n-star), or leave it out");
}

void check_step(const sim::SolverSetting& setting, const Protocol& protocol, const std::string& place) {
  const double step_s = 1 / setting[sim::SolverKnob::Rate], asked_s = protocol.content.content_step_s;
  if (std::abs(step_s - asked_s) <= 1e-3 * asked_s) return;
  throw base::Error(
      place,
      fmt::format("was chosen for frames of content {:.6g} s apart (frames_per_s = {:.6g}), and "
                  "the protocol's content step is {:.6g} s",
                  step_s, setting[sim::SolverKnob::Rate], asked_s),
      "choose a setting for the protocol's content step (vip-bench accuracy --budget … --of-rate), or change "
      "content_step_s of the protocol");
}

}  // namespace

SessionSettings::SessionSettings(const std::vector<std::string>& texts, const Protocol& protocol,
                                 const std::string& place) {
  for (const std::string& text : texts) {
    Setting one{sim::parse_setting_file(text, place), base::sha256_hex(text)};
    check_shown(one.file.setting, protocol, place);
    check_step(one.file.setting, protocol, place);
    for (const Setting& other : settings_) {
      if (other.file.setting.method == one.file.setting.method &&
          other.file.setting[sim::SolverKnob::Size] == one.file.setting[sim::SolverKnob::Size])
        throw base::Error(place, "is a second setting for " + named(one.file.setting), "give one of them");
    }
    settings_.push_back(std::move(one));
  }
}

const sim::SettingFile* SessionSettings::of(const StimulusSpec& stimulus) const {
  for (const Setting& one : settings_)
    if (is_for(one.file.setting, stimulus)) return &one.file;
  return nullptr;
}

std::string SessionSettings::description() const {
  std::string out;
  for (const Setting& one : settings_)
    out += "; at setting " + one.sha256 + " (" + sim::to_text(one.file.setting) + ")";
  return out;
}

std::vector<std::string> SessionSettings::notes(const Protocol& protocol) const {
  std::vector<std::string> out;
  for (const Setting& one : settings_) {
    const sim::SolverSetting& setting = one.file.setting;
    const std::string name = "setting " + one.sha256.substr(0, 12) + ": ";
    out.push_back(name + sim::describe(one.file));
    std::set<std::string> scenes;
    for (const Cell& cell : protocol.design.cells)
      if (is_for(setting, cell.stimulus)) scenes.insert(cell.stimulus.scene);
    for (const std::string& scene : scenes) {
      const auto note = sim::other_scene(one.file, sim::read_scene(base::find_input(scene)).sha256);
      if (!note.empty()) out.push_back(name + scene + ": " + note);
    }
    const bool some_rest =
        sim::turns(sim::SolverKnob::Beta, setting.method) && setting[sim::SolverKnob::Beta] < 1;
    if (some_rest || sim::traits_of(setting.method).temporal)
      out.push_back(name + "tau follows its beta, " +
                    sim::value_words(sim::SolverKnob::Beta, setting[sim::SolverKnob::Beta]) +
                    ", and not the frame rate");
  }
  return out;
}

}  // namespace study
