#include "apps/study/session_setup.hpp"

#include "apps/common/fluid_stimulus.hpp"
#include "apps/common/headless_display.hpp"
#include "libstudy/display/null.hpp"
#include "libstudy/observer/ptpe_observer.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

[[noreturn]] void unknown(const std::string& option, const std::string& word, const std::string& known) {
  throw base::Error(option, "'" + word + "' is not known", "use " + known);
}

std::unique_ptr<study::Clock> make_clock(const std::string& word) {
  if (word == "virtual") return std::make_unique<study::VirtualClock>();
  if (word == "real") return std::make_unique<study::RealClock>();
  unknown("--clock", word, "real or virtual");
}

std::unique_ptr<study::Display> make_display(const RunOptions& options) {
  if (options.display == "none") return std::make_unique<study::NullDisplay>();
  if (options.display == "headless") {
    StimulusChoice choice;
    choice.bake = options.bake;
    return std::make_unique<HeadlessDisplay>(options.width_px, options.height_px, shows_pictures(choice));
  }
  unknown("--display", options.display, "none or headless");
}

std::unique_ptr<study::Stimulus> make_shown_stimulus(const RunOptions& options,
                                                     const study::Protocol& protocol) {
  if (options.bake.empty() && options.display == "none") {
    return std::make_unique<study::NullStimulus>(protocol.content.content_step_s);
  }
  StimulusChoice choice;
  choice.bake = options.bake;
  choice.content_step_s = protocol.content.content_step_s;
  choice.backend = options.backend;
  if (options.bake.empty()) {
    choice.scene = base::find_input(protocol.stimulus.scene);
    choice.method = protocol.stimulus.method;
    choice.n_star = protocol.stimulus.n_star;
  }
  return make_stimulus(choice);
}

std::string instead(const std::string& what, const std::string& shown, const std::string& wanted) {
  return shown == wanted ? "" : what + " " + shown + " instead of " + wanted;
}

std::string departure_of(const RunOptions& options, const study::Protocol& protocol) {
  if (options.bake.empty()) return {};
  const sim::BakeReader bake(options.bake);
  const sim::BakeHeader& header = bake.header();
  const sim::Scene scene = sim::read_scene(base::find_input(protocol.stimulus.scene));
  std::string all;
  for (const std::string& one :
       {instead("scene", header.scene_name + " " + header.scene_sha256.substr(0, 12),
                scene.name + " " + scene.sha256.substr(0, 12)),
        instead("method", header.method, sim::method_name(sim::parse_method(protocol.stimulus.method))),
        instead("n_*", std::to_string(header.n_star),
                std::to_string(sim::parse_n_star(protocol.stimulus.n_star)))}) {
    if (!one.empty()) all += (all.empty() ? "" : ", ") + one;
  }
  return all;
}

}  // namespace

SessionSetup make_session_setup(const RunOptions& options, const study::Protocol& protocol) {
  SessionSetup setup;
  setup.responder = std::make_unique<study::PtpeObserver>(study::parse_ptpe_observer(options.observer));
  setup.virtual_clock = options.clock == "virtual";
  setup.clock = make_clock(options.clock);
  setup.display = make_display(options);
  setup.stimulus = make_shown_stimulus(options, protocol);
  setup.departure = departure_of(options, protocol);
  return setup;
}

}  // namespace apps
