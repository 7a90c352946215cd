#include "libsim/measure/timed_run.hpp"

#include <fmt/format.h>

#include <numbers>
#include <utility>

#include "libsim/solver/settled_state.hpp"
#include "stats/base/machine.hpp"
#include "stats/base/progress.hpp"

namespace measure {

std::unique_ptr<sim::Simulation> make_settled(const sim::Scene& scene, sim::SimulationOptions options) {
  options.cache = sim::default_cache_folder();
  base::Progress progress("settling", static_cast<std::size_t>(std::max(1, scene.settle_frames)));
  options.settling = [&](int done, int) { progress.update(static_cast<std::size_t>(done)); };
  return sim::make_simulation(scene, options);
}

std::string processor() {
  const std::string machine = base::describe_machine();
  const auto end = machine.find("; ");
  return end == std::string::npos ? machine : machine.substr(end + 2);
}

base::Json effect_books(const sim::Scene& scene, const sim::FrameReport& report) {
  base::Json out = base::Json::object();
  for (const sim::Effect& effect : scene.effects) {
    if (effect.coefficient == 0) continue;
    if (effect.kind == sim::EffectKind::Foam) {
      const auto& foam = report.foam;
      const double d = effect.options[static_cast<std::size_t>(sim::EffectOption::FoamDiameter)];
      out["foam"] = {{"emitted", foam.emitted},
                     {"emitted_m3", static_cast<double>(foam.emitted) * std::numbers::pi / 6 * d * d * d},
                     {"spray", foam.spray},
                     {"foam", foam.foam},
                     {"bubbles", foam.bubbles},
                     {"dissolved", foam.dissolved},
                     {"dropped", foam.dropped},
                     {"left", foam.left}};
    }
    if (effect.kind == sim::EffectKind::Heat) {
      const auto& heat = report.heat;
      out["heat"] = {{"held", heat.held},
                     {"poured", heat.poured},
                     {"taken", heat.taken},
                     {"drained", heat.drained},
                     {"from_walls", heat.from_walls}};
    }
  }
  return out;
}

std::string in_words(const base::Json& books) {
  std::string out;
  if (books.contains("foam")) {
    const auto& foam = books["foam"];
    const auto count = [&](const char* key) { return foam[key].get<std::uint64_t>(); };
    out += fmt::format(
        "  foam         {} made, {:.4g} m3: {} in the air, {} on the water, {} in it; {} dissolved, "
        "{} dropped because the pool was full, {} left\n",
        count("emitted"), foam["emitted_m3"].get<double>(), count("spray"), count("foam"), count("bubbles"),
        count("dissolved"), count("dropped"), count("left"));
  }
  if (books.contains("heat")) {
    const auto& heat = books["heat"];
    const auto amount = [&](const char* key) { return heat[key].get<double>(); };
    out += fmt::format(
        "  heat         {:.6g} K m_* held; {:.4g} poured, {:.4g} taken by nozzles, {:.4g} drained, "
        "{:.4g} from walls\n",
        amount("held"), amount("poured"), amount("taken"), amount("drained"), amount("from_walls"));
  }
  return out;
}

}  // namespace measure
