#include "stats/base/toml_state.hpp"

#include <cmath>
#include <sstream>

#include "stats/base/error.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace base {

namespace {

constexpr std::size_t longest_problem = 400;  // bytes; the text may quote a value of any length

/// "known keys here: a, b", followed by the one nearest to `key`.
std::string known_keys(std::string_view key, const std::map<std::string, AskedKey, std::less<>>& asked) {
  std::vector<std::string> names;
  for (const auto& [name, what] : asked) names.push_back(name);
  const std::string nearest = nearest_word(key, names);
  return "known keys here: " + joined(names) + (nearest.empty() ? "" : "; the nearest is " + nearest);
}

/// "block[3].question[0]" without its indices.
std::string without_indices(const std::string& path) {
  std::string out;
  bool inside = false;
  for (const char c : path) {
    inside = inside || c == '[';
    if (!inside) out += c;
    inside = inside && c != ']';
  }
  return out;
}

}  // namespace

std::string place_of(const std::string& file, const toml::source_region& region) {
  std::ostringstream out;
  out << file;
  if (region.begin) out << ':' << region.begin.line << ':' << region.begin.column;
  return out.str();
}

std::string shown(double value) {
  std::ostringstream out;
  out.precision(12);
  out << value;
  return out.str();
}

std::string TomlTable::State::name(std::string_view key) const {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

void TomlTable::State::fail(const toml::node* node, std::string_view key, const std::string& problem,
                            const std::string& mend) const {
  const auto& region = node ? node->source() : table->source();
  const std::string what = shortened(key.empty() ? path : name(key));
  throw Error(place_of(file, region),
              (what.empty() ? "" : "'" + what + "' ") + shortened(problem, longest_problem), mend);
}

const toml::node* TomlTable::State::find(std::string_view key) const {
  asked.try_emplace(std::string(key));
  return table->get(key);
}

void TomlTable::State::note(std::string_view key, const char* type, std::optional<Range> range,
                            const std::vector<std::string>& choices) const {
  AskedKey& what = asked[std::string(key)];
  what.type = type;
  if (range) what.range = range;
  if (!choices.empty()) what.choices = choices;
}

void TomlTable::State::note_fallback(std::string_view key, std::string fallback) const {
  asked[std::string(key)].fallback = std::move(fallback);
}

void TomlTable::State::collect(std::map<std::string, AskedKey>& out) const {
  for (const auto& [key, what] : asked) {
    AskedKey& all = out[without_indices(name(key))];
    if (!what.type.empty()) all.type = what.type;
    if (what.range) all.range = what.range;
    if (!what.choices.empty()) all.choices = what.choices;
    if (!what.fallback.empty()) all.fallback = what.fallback;
  }
  for (const auto& child : children) child->collect(out);
}

const toml::node& TomlTable::State::need(std::string_view key) const {
  const toml::node* node = find(key);
  if (!node) fail(nullptr, key, "is missing", "add '" + std::string(key) + " = ...' to this table");
  return *node;
}

double TomlTable::State::in_range(const toml::node& node, std::string_view key, Range range) const {
  const auto value = node.value<double>();
  if (!node.is_number() || !value) fail(&node, key, "must be a number", "write it without quotes");
  if (!std::isfinite(*value)) fail(&node, key, "must be finite", "write an ordinary number");
  if (*value < range.min || *value > range.max) {
    fail(&node, key, "= " + shown(*value) + " is out of range", "use a value in " + range_text(range));
  }
  return *value;
}

std::int64_t TomlTable::State::whole(const toml::node& node, std::string_view key, Range range) const {
  if (!node.is_integer()) fail(&node, key, "must be a whole number", "write it without a fraction or quotes");
  in_range(node, key, range);
  return *node.value<std::int64_t>();
}

std::shared_ptr<TomlTable::State> TomlTable::State::child(const toml::table& node,
                                                          std::string child_path) const {
  auto state = std::make_shared<State>();
  state->root = root;
  state->table = &node;
  state->file = file;
  state->path = std::move(child_path);
  children.push_back(state);
  return state;
}

void TomlTable::State::finish() const {
  for (const auto& [key, node] : *table) {
    if (asked.count(std::string(key.str()))) continue;
    fail(&node, key.str(), "is not a known key", known_keys(key.str(), asked));
  }
  for (const auto& state : children) state->finish();
}

}  // namespace base
