#include "libstudy/observer/specification.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

void fail_observer(std::string_view specification, std::size_t at, const std::string& problem,
                   const std::string& mend) {
  throw base::Error("observer '" + std::string(specification) + "', character " + std::to_string(at + 1),
                    problem, mend);
}

namespace {

double parse_number(std::string_view specification, std::size_t at, std::string_view text,
                    const std::string& mend) {
  const auto value = base::parse_number<double>(text);
  if (!value || !std::isfinite(*value))
    fail_observer(specification, at, "'" + std::string(text) + "' is not a number", mend);
  return *value;
}

}  // namespace

double read_observer_number(std::string_view specification, std::size_t at, std::string_view text, double min,
                            double max, const std::string& mend) {
  const double value = parse_number(specification, at, text, mend);
  if (value < min || value > max)
    fail_observer(
        specification, at,
        std::string(text) + " is out of range: " + shortest_number(min) + " to " + shortest_number(max),
        mend);
  return value;
}

void read_observer_keys(std::string_view specification, std::size_t at, std::span<const ObserverKey> keys,
                        const std::string& mend) {
  std::vector<bool> given(keys.size());
  while (at <= specification.size()) {
    const std::size_t end = std::min(specification.find(',', at), specification.size());
    const std::string_view pair = specification.substr(at, end - at);
    const std::size_t equals = pair.find('=');
    if (equals == std::string_view::npos) fail_observer(specification, at, "expected key=number", mend);
    const auto named = [&](const ObserverKey& key) { return key.name == pair.substr(0, equals); };
    const auto key = std::find_if(keys.begin(), keys.end(), named);
    const std::string name(pair.substr(0, equals));
    if (key == keys.end()) fail_observer(specification, at, "unknown key '" + name + "'", mend);
    const auto index = static_cast<std::size_t>(key - keys.begin());
    if (given[index]) fail_observer(specification, at, "key '" + name + "' is given twice", mend);
    given[index] = true;
    const std::string_view text = pair.substr(equals + 1);
    const double value = parse_number(specification, at + equals + 1, text, mend);
    if (value < key->min || value > key->max || (key->open_min && value == key->min)) {
      fail_observer(
          specification, at + equals + 1,
          name + " = " + std::string(text) + " is out of range: " + (key->open_min ? "above " : "from ") +
              shortest_number(key->min) + (std::isinf(key->max) ? "" : " to " + shortest_number(key->max)),
          mend);
    }
    *key->value = value;
    at = end + 1;
  }
  for (std::size_t index = 0; index < keys.size(); ++index) {
    if (keys[index].required && !given[index]) {
      fail_observer(specification, specification.size(),
                    "key '" + std::string(keys[index].name) + "' is missing", mend);
    }
  }
}

std::string shortest_number(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

std::string write_observer_keys(std::span<const ObserverKey> keys) {
  std::string text;
  for (const ObserverKey& key : keys) {
    if (!text.empty()) text += ',';
    text += std::string(key.name) + "=" + shortest_number(*key.value);
  }
  return text;
}

}  // namespace study
