#include "libstudy/trackers/tracker_line.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::string_view hello_word = "vip-gaze", format_number = "1";
constexpr std::size_t most_name_bytes = 100;
/// Nanoseconds of twice this time fit into 64 bits, so that a time and an offset can be added, s.
constexpr double most_seconds = 4e9;

std::vector<std::string_view> words_of(std::string_view line) {
  std::vector<std::string_view> words;
  while (!line.empty()) {
    const std::size_t end = std::min(line.find(' '), line.size());
    if (end > 0) words.push_back(line.substr(0, end));
    line.remove_prefix(std::min(end + 1, line.size()));
  }
  return words;
}

std::optional<std::int64_t> nanoseconds(std::string_view text) {
  const auto seconds = base::parse_number<double>(text);
  if (!seconds || !std::isfinite(*seconds) || std::abs(*seconds) > most_seconds) return {};
  return std::llround(*seconds * 1e9);
}

TrackerLine hello_of(std::string_view line) {
  std::string_view rest = line.substr(hello_word.size());
  if (!rest.starts_with(" " + std::string(format_number) + " "))
    return UnreadableLine{"speaks another format than 1"};
  rest.remove_prefix(format_number.size() + 2);
  if (rest.empty() || rest.size() > most_name_bytes || !base::is_plain_line(rest) || base::is_blank(rest))
    return UnreadableLine{"gives no name of up to 100 bytes"};
  return TrackerHello{std::string(rest)};
}

TrackerLine sample_of(const std::vector<std::string_view>& words) {
  TrackerSample sample;
  const auto device_ns = words.size() >= 3 ? nanoseconds(words[1]) : std::nullopt;
  if (!device_ns) return UnreadableLine{"a sample has no time"};
  sample.device_ns = *device_ns;
  sample.valid = words[2] == "1";
  if (!sample.valid && words[2] != "0") return UnreadableLine{"a sample's validity is neither 0 nor 1"};
  if (!sample.valid) return sample;
  if (words.size() != 6) return UnreadableLine{"a valid sample has no direction of three numbers"};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto along = base::parse_number<double>(words[3 + k]);
    if (!along) return UnreadableLine{"a direction is no number"};
    sample.direction[k] = *along;
  }
  if (!normalise(sample.direction)) return UnreadableLine{"a direction has no length, or is not finite"};
  return sample;
}

TrackerLine pong_of(const std::vector<std::string_view>& words) {
  const auto number = words.size() == 3 ? base::parse_number<std::int64_t>(words[1]) : std::nullopt;
  const auto device_ns = number ? nanoseconds(words[2]) : std::nullopt;
  if (!device_ns) return UnreadableLine{"an answer to a ping has no number and time"};
  return TrackerPong{*number, *device_ns};
}

}  // namespace

bool normalise(std::array<double, 3>& direction) {
  // hypot keeps tiny and huge vectors from underflow and overflow.
  const double length = std::hypot(direction[0], direction[1], direction[2]);
  if (!std::isfinite(length) || !(length > 1e-300)) return false;
  for (double& along : direction) along /= length;
  return true;
}

TrackerLine parse_tracker_line(std::string_view line) {
  if (line.ends_with('\r')) line.remove_suffix(1);
  if (line.size() > most_line_bytes) return UnreadableLine{"a line is longer than 200 bytes"};
  if (line.starts_with(hello_word)) return hello_of(line);
  const auto words = words_of(line);
  if (words.empty()) return UnreadableLine{"a line is empty"};
  if (words[0] == "g") return sample_of(words);
  if (words[0] == "p") return pong_of(words);
  return UnreadableLine{"a line begins with neither g nor p"};
}

std::string ping_line(std::int64_t number) { return "p " + std::to_string(number) + "\n"; }

}  // namespace study
