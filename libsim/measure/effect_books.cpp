#include "libsim/measure/effect_books.hpp"

#include <fmt/format.h>

#include <numbers>

namespace measure {

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
        "{} found no room, {} left\n",
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
