#include "libsim/scene/effects.hpp"

#include <algorithm>
#include <cmath>
#include <string_view>

#include "libsim/scene/picture_effects.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml.hpp"

namespace sim {

namespace {

constexpr std::string_view coarsest_level = "coarsest_level";
constexpr const char* without_effects = "is an effect, and this program was built without them";
constexpr const char* build_them = "build it with -DVIP_EFFECTS=ON, or take the effect out of the scene";

constexpr std::array<EffectTraits, effect_count> all_traits{{
#define SIM_TRAITS(Name, word, key, unit, longest, needs, source) \
  {#word, #key, EffectUnit::unit, longest, needs, source},
    SIM_EFFECTS(SIM_TRAITS)
#undef SIM_TRAITS
}};

constexpr std::array<OptionTraits, option_count> option_traits{{
#define SIM_TRAITS(Name, effect, key, usual, least, most) {EffectKind::effect, #key, usual, least, most},
    SIM_EFFECT_OPTIONS(SIM_TRAITS)
#undef SIM_TRAITS
}};

bool is_whole(std::size_t option) {
  const auto which = static_cast<EffectOption>(option);
  return which == EffectOption::ViscositySteps || which == EffectOption::FoamMost ||
         std::string_view(option_traits[option].key) == coarsest_level;
}

std::vector<std::string> all_words() {
  std::vector<std::string> out;
  for (const EffectTraits& traits : all_traits) out.emplace_back(traits.word);
  return out;
}

const Effect* find(const std::vector<Effect>& effects, EffectKind kind) {
  const auto found =
      std::find_if(effects.begin(), effects.end(), [&](const Effect& effect) { return effect.kind == kind; });
  return found == effects.end() ? nullptr : &*found;
}

/// True if the effect needs no other effect, has the coefficient 0, or the list has the effect that it needs
/// with a coefficient above 0.
bool stands(const std::vector<Effect>& effects, const Effect& effect) {
  const EffectKind needs = traits_of(effect.kind).needs;
  if (needs == no_effect || effect.coefficient == 0) return true;
  const Effect* other = find(effects, needs);
  return other && other->coefficient > 0;
}

std::string needs_text(const Effect& effect) {
  return std::string("needs ") + traits_of(traits_of(effect.kind).needs).word +
         ", which is missing or has the coefficient 0";
}
std::string needs_mend(const Effect& effect) {
  return std::string("list ") + traits_of(traits_of(effect.kind).needs).word +
         " too with a coefficient above 0, or leave out " + traits_of(effect.kind).word;
}

double natural_time(const Effect& effect, double d) {
  switch (traits_of(effect.kind).unit) {
    case EffectUnit::NewtonPerMetre:
      return std::sqrt(rest_density_kg_m3 * d * d * d / effect.coefficient);
    case EffectUnit::PerSecond:
      return 1 / effect.coefficient;
    case EffectUnit::MetrePerSecond:
      return d / effect.coefficient;
    case EffectUnit::MetreSquaredPerSecond:
      return d * d / effect.coefficient;
    case EffectUnit::Unlimited:
      break;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

const EffectTraits& traits_of(EffectKind kind) { return all_traits[static_cast<std::size_t>(kind)]; }

const OptionTraits& traits_of(EffectOption option) { return option_traits[static_cast<std::size_t>(option)]; }

std::optional<EffectOption> coarsest_level_of(EffectKind kind) {
  for (EffectKind of = kind; of != no_effect; of = traits_of(of).needs)
    for (std::size_t k = 0; k < option_count; ++k)
      if (option_traits[k].of == of && std::string_view(option_traits[k].key) == coarsest_level)
        return static_cast<EffectOption>(k);
  return {};
}

std::string options_in_words(const Effect& effect) {
  std::string out;
  for (std::size_t k = 0; k < option_count; ++k)
    if (option_traits[k].of == effect.kind)
      out += std::string(" ") + option_traits[k].key + " = " + base::shortest(effect.options[k]);
  return out;
}

EffectCoefficients coefficients_of(const std::vector<Effect>& effects) {
  EffectCoefficients out;
  for (const Effect& effect : effects) {
    out.values[static_cast<std::size_t>(effect.kind)] = static_cast<float>(effect.coefficient);
    for (std::size_t k = 0; k < option_count; ++k)
      if (option_traits[k].of == effect.kind) out.options[k] = effect.options[k];
  }
  return out;
}

std::optional<EffectKind> effect_named(const std::string& word) {
  const auto words = all_words();
  const auto found = std::find(words.begin(), words.end(), word);
  if (found == words.end()) return {};
  return static_cast<EffectKind>(found - words.begin());
}

bool is_idle(const Effect& effect, const std::vector<Effect>& among, int finest_level) {
  const auto option = coarsest_level_of(effect.kind);
  return option && finest_level > static_cast<int>(coefficients_of(among)[*option]);
}

std::vector<Effect> acting_effects(const std::vector<Effect>& effects, int finest_level) {
  std::vector<Effect> out;
  for (const Effect& effect : effects)
    if (!is_idle(effect, effects, finest_level)) out.push_back(effect);
  return out;
}

std::string format_effects(const std::vector<Effect>& effects) {
  std::string out;
  for (const Effect& effect : effects) {
    if (effect.coefficient == 0) continue;
    out += std::string("[[effect]]\nkind = \"") + traits_of(effect.kind).word + "\"\n" +
           traits_of(effect.kind).key + " = " + base::shortest(effect.coefficient) + "\n";
    for (std::size_t k = 0; k < option_count; ++k)
      if (option_traits[k].of == effect.kind)
        out += std::string(option_traits[k].key) + " = " + base::shortest(effect.options[k]) + "\n";
  }
  return out;
}

std::string effects_in_words(const std::vector<Effect>& effects) {
  std::string out;
  for (const Effect& effect : effects) {
    if (effect.coefficient == 0) continue;
    out += std::string(out.empty() ? "" : "; ") + traits_of(effect.kind).word + ' ' +
           traits_of(effect.kind).key + " = " + base::shortest(effect.coefficient) + options_in_words(effect);
  }
  return out;
}

std::vector<Effect> read_effects(const std::vector<base::TomlTable>& tables,
                                 const std::vector<Effect>& kept) {
  auto known = all_words();
  for (const std::string& word : picture_effect_words()) known.push_back(word);
  std::vector<base::TomlTable> read;
  std::vector<Effect> out = kept;
  for (const auto& table : tables) {
    const auto named = effect_named(table.choice("kind", known));
    if (!named) continue;  // a picture effect, which read_picture_effects() reads
    const EffectKind kind = *named;
    if (!has_effects()) table.fail("kind", without_effects, build_them);
    if (find(out, kind)) table.fail("kind", "is listed twice", "keep one of the two");
    Effect effect{kind, table.number(traits_of(kind).key, {0, largest_coefficient})};
    for (std::size_t k = 0; k < option_count; ++k) {
      const OptionTraits& option = option_traits[k];
      if (option.of != kind) continue;
      effect.options[k] = table.number_or(option.key, option.usual, {option.least, option.most});
      if (is_whole(k) && effect.options[k] != std::floor(effect.options[k]))
        table.fail(option.key, "= " + base::shortest(effect.options[k]) + " is no whole number",
                   "write for example " + base::shortest(option.usual));
    }
    out.push_back(effect);
    read.push_back(table);
  }
  for (std::size_t i = 0; i < read.size(); ++i) {
    const Effect& effect = out[kept.size() + i];
    if (!stands(out, effect)) read[i].fail("kind", needs_text(effect), needs_mend(effect));
  }
  return out;
}

void check_effects(const std::vector<Effect>& effects) {
  for (const Effect& effect : effects) {
    const auto fail = [&](const std::string& problem, const std::string& mend) {
      throw base::Error(std::string("effect ") + traits_of(effect.kind).word, problem, mend);
    };
    if (!has_effects()) fail(without_effects, build_them);
    if (find(effects, effect.kind) != &effect) fail("is listed twice", "keep one of the two");
    if (!(effect.coefficient >= 0 && effect.coefficient <= largest_coefficient))
      fail(std::string(traits_of(effect.kind).key) + " = " + base::shortest(effect.coefficient) +
               " is out of range",
           "use 0 to 1e6");
    for (std::size_t k = 0; k < option_count; ++k) {
      const OptionTraits& option = option_traits[k];
      if (option.of == effect.kind &&
          !(effect.options[k] >= option.least && effect.options[k] <= option.most))
        fail(std::string(option.key) + " = " + base::shortest(effect.options[k]) + " is out of range",
             "use " + base::shortest(option.least) + " to " + base::shortest(option.most));
    }
    if (!stands(effects, effect)) fail(needs_text(effect), needs_mend(effect));
  }
}

EffectStep longest_step(const std::vector<Effect>& effects, double finest_spacing_m) {
  EffectStep out;
  for (const Effect& effect : effects) {
    if (effect.coefficient == 0) continue;
    const double seconds = traits_of(effect.kind).longest_step * natural_time(effect, finest_spacing_m);
    if (seconds < out.seconds) out = {seconds, effect.kind};
  }
  return out;
}

double capillary_speed(const std::vector<Effect>& effects, double finest_spacing_m) {
  double tension = 0;
  for (const Effect& effect : effects)
    if (traits_of(effect.kind).unit == EffectUnit::NewtonPerMetre) tension += effect.coefficient;
  return std::sqrt(12 * tension / (rest_density_kg_m3 * finest_spacing_m));
}

bool has_effects() {
#ifdef VIP_NO_EFFECTS
  return false;
#else
  return true;
#endif
}

}  // namespace sim
