#include "libsim/methods/method.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "stats/base/error.hpp"

namespace sim {

namespace {
std::string lower(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return out;
}
}  // namespace

MethodKind parse_method(std::string_view name) {
  const std::string word = lower(name);
  if (word == "lores") return MethodKind::LoRes;
  if (word == "hires") return MethodKind::HiRes;
  throw base::Error("method \"" + std::string(name) + "\"", "is not known", "use LoRes or HiRes");
}

std::string method_name(MethodKind method) { return method == MethodKind::LoRes ? "LoRes" : "HiRes"; }

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
  return method == MethodKind::LoRes ? n_star : 8 * n_star;
}

}  // namespace sim
