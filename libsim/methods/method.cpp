#include "libsim/methods/method.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "stats/base/error.hpp"
#include "stats/base/nearest.hpp"

namespace sim {

namespace {
std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}
}  // namespace

const std::array<MethodTraits, 5>& all_methods() {
  using Target = TargetSource;
  static constexpr std::array<MethodTraits, 5> methods{{
      {MethodKind::LoRes, "LoRes", Target::None, false, 3},
      {MethodKind::HiRes, "HiRes", Target::None, false, 0},
      {MethodKind::FovFluid, "FovFluid", Target::Gaze, false, 0},
      {MethodKind::Ours, "Ours", Target::Saliency, false, 0},
      {MethodKind::OursTsp, "Ours-TSp", Target::Saliency, true, 0},
  }};
  return methods;
}

const MethodTraits& traits_of(MethodKind method) { return all_methods()[static_cast<std::size_t>(method)]; }

MethodKind parse_method(std::string_view name) {
  const std::string word = lower(name);
  for (const auto& method : all_methods()) {
    if (word == lower(method.name)) return method.kind;
  }
  std::vector<std::string> known;
  for (const auto& method : all_methods()) known.emplace_back(method.name);
  throw base::Error("method \"" + std::string(name) + "\"", "is not known", base::use_one_of(name, known));
}

std::string method_name(MethodKind method) { return traits_of(method).name; }

std::string method_names() {
  std::string out;
  for (const auto& method : all_methods()) {
    if (!out.empty()) out += method.kind == all_methods().back().kind ? " or " : ", ";
    out += method.name;
  }
  return out;
}

std::int64_t parse_n_star(std::string_view text) {
  std::int64_t value = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  const bool kilo = rest + 1 == end && (*rest == 'k' || *rest == 'K');
  constexpr std::int64_t most = 4 << 20;
  const bool readable = error == std::errc() && (rest == end || kilo) && value > 0 && value <= most;
  if (readable && kilo) value *= 1024;
  if (!readable || value < 64 || value > most) {
    throw base::Error("n_* \"" + std::string(text) + "\"", "is not a particle count from 64 to 4096k",
                      "write a whole number, or one with k for 1,024, for example 32k");
  }
  return value;
}

std::int64_t particle_count(MethodKind method, std::int64_t n_star) {
  return (8 * n_star) >> traits_of(method).start_level;
}

}  // namespace sim
