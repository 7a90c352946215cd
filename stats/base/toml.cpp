#include "stats/base/toml.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "stats/base/error.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"
#include "stats/base/toml_parser.hpp"
#include "stats/base/toml_text.hpp"

namespace base {

namespace {

constexpr std::size_t longest_problem = 400;  // bytes; the text may quote a value of any length

/// Advice such as "known keys here: a, b", followed by the known key nearest to `key`.
std::string known_keys(std::string_view key, const std::map<std::string, AskedKey, std::less<>>& asked) {
  std::vector<std::string> names;
  for (const auto& [name, what] : asked) names.push_back(name);
  const std::string nearest = nearest_word(key, names);
  return "known keys here: " + joined(names) + (nearest.empty() ? "" : "; the nearest is " + nearest);
}

/// The path without indices: "block.question" for "block[3].question[0]".
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

/// The place as "file:line:column".
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

}  // namespace

/// A table of the document, with the keys and the child tables that the reader has looked up so far.
struct TomlTable::State {
  using Asked = std::map<std::string, AskedKey, std::less<>>;

  std::shared_ptr<const toml::table> root;
  const toml::table* table = nullptr;
  std::string file;
  std::string path;  ///< dotted, empty for the root
  mutable Asked asked;
  mutable std::vector<std::shared_ptr<State>> children;

  std::string name(std::string_view key) const;
  [[noreturn]] void fail(const toml::node* node, std::string_view key, const std::string& problem,
                         const std::string& mend) const;
  /// Looks up a key and records that the reader knows it: finish() refuses all other keys.
  const toml::node* find(std::string_view key) const;
  const toml::node& need(std::string_view key) const;
  void note(std::string_view key, const char* type, std::optional<Range> range = {},
            const std::vector<std::string>& choices = {}) const;
  void note_fallback(std::string_view key, std::string fallback) const;
  void collect(std::map<std::string, AskedKey>& out) const;
  double in_range(const toml::node& node, std::string_view key, Range range) const;
  std::int64_t whole(const toml::node& node, std::string_view key, Range range) const;
  std::shared_ptr<State> child(const toml::table& node, std::string child_path) const;
  void finish() const;
};

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
  // toml++ gives no double for a whole number of more than 53 bits.
  const auto whole = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
  const auto value = whole ? static_cast<double>(*whole) : node.value<double>();
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

std::string range_text(Range range) {
  return (range.min == positive.min ? "(0" : "[" + shown(range.min)) + ", " + shown(range.max) + "]";
}

TomlTable::TomlTable(std::shared_ptr<State> state) : state_(std::move(state)) {}

bool TomlTable::has(std::string_view key) const { return state_->find(key) != nullptr; }

bool TomlTable::is_text(std::string_view key) const {
  const toml::node* node = state_->find(key);
  return node && node->is_string();
}

bool TomlTable::is_list(std::string_view key) const {
  const toml::node* node = state_->find(key);
  return node && node->is_array();
}

double TomlTable::number(std::string_view key, Range range) const {
  state_->note(key, "number", range);
  return state_->in_range(state_->need(key), key, range);
}

std::int64_t TomlTable::integer(std::string_view key, Range range) const {
  state_->note(key, "whole number", range);
  return state_->whole(state_->need(key), key, range);
}

bool TomlTable::boolean(std::string_view key) const {
  state_->note(key, "true or false");
  const auto& node = state_->need(key);
  if (!node.is_boolean())
    state_->fail(&node, key, "must be true or false", "write true or false without quotes");
  return *node.value<bool>();
}

std::string TomlTable::string(std::string_view key) const {
  state_->note(key, "text");
  const auto& node = state_->need(key);
  if (!node.is_string()) state_->fail(&node, key, "must be text", "put it in double quotes");
  return *node.value<std::string>();
}

std::string TomlTable::choice(std::string_view key, const std::vector<std::string>& allowed) const {
  state_->note(key, "text", {}, allowed);
  const std::string value = string(key);
  if (std::find(allowed.begin(), allowed.end(), value) != allowed.end()) return value;
  state_->fail(state_->find(key), key, "= \"" + value + "\" is not a known choice",
               use_one_of(value, allowed));
}

std::vector<double> TomlTable::numbers(std::string_view key, std::size_t size, Range range) const {
  state_->note(key, "list of numbers", range);
  const auto& node = state_->need(key);
  const toml::array* array = node.as_array();
  if (!array) state_->fail(&node, key, "must be a list of numbers", "write [a, b, ...]");
  if (size && array->size() != size) {
    state_->fail(&node, key, "has " + std::to_string(array->size()) + " entries",
                 "give exactly " + std::to_string(size));
  }
  std::vector<double> out;
  for (const auto& element : *array) out.push_back(state_->in_range(element, key, range));
  return out;
}

std::vector<std::string> TomlTable::strings(std::string_view key) const {
  state_->note(key, "list of texts");
  const auto& node = state_->need(key);
  const toml::array* array = node.as_array();
  if (!array) state_->fail(&node, key, "must be a list of texts", "write [\"a\", \"b\"]");
  std::vector<std::string> out;
  for (const auto& element : *array) {
    if (!element.is_string())
      state_->fail(&element, key, "must hold texts only", "put each entry in double quotes");
    out.push_back(*element.value<std::string>());
  }
  return out;
}

std::vector<std::string> TomlTable::keys() const {
  std::vector<std::pair<toml::source_position, std::string>> placed;
  for (const auto& [key, node] : *state_->table) placed.emplace_back(node.source().begin, key.str());
  std::stable_sort(placed.begin(), placed.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> out;
  for (auto& [place, key] : placed) out.push_back(std::move(key));
  return out;
}

TomlTable TomlTable::table(std::string_view key) const {
  state_->note(key, "table");
  const auto& node = state_->need(key);
  if (!node.is_table()) state_->fail(&node, key, "must be a table", "write [" + state_->name(key) + "]");
  return TomlTable(state_->child(*node.as_table(), state_->name(key)));
}

std::vector<TomlTable> TomlTable::tables(std::string_view key) const {
  state_->note(key, "tables");
  std::vector<TomlTable> out;
  const toml::node* node = state_->find(key);
  if (!node) return out;
  const toml::array* array = node->as_array();
  if (!array) state_->fail(node, key, "must be an array of tables", "write [[" + state_->name(key) + "]]");
  for (const auto& element : *array) {
    if (!element.is_table())
      state_->fail(&element, key, "must hold tables only", "write [[" + state_->name(key) + "]]");
    out.emplace_back(
        state_->child(*element.as_table(), state_->name(key) + "[" + std::to_string(out.size()) + "]"));
  }
  return out;
}

double TomlTable::number_or(std::string_view key, double fallback, Range range) const {
  state_->note(key, "number", range);
  state_->note_fallback(key, shown(fallback));
  return has(key) ? number(key, range) : fallback;
}
std::int64_t TomlTable::integer_or(std::string_view key, std::int64_t fallback, Range range) const {
  state_->note(key, "whole number", range);
  state_->note_fallback(key, std::to_string(fallback));
  return has(key) ? integer(key, range) : fallback;
}
bool TomlTable::boolean_or(std::string_view key, bool fallback) const {
  state_->note(key, "true or false");
  state_->note_fallback(key, fallback ? "true" : "false");
  return has(key) ? boolean(key) : fallback;
}
std::string TomlTable::string_or(std::string_view key, const std::string& fallback) const {
  state_->note(key, "text");
  state_->note_fallback(key, toml_quoted(fallback));
  return has(key) ? string(key) : fallback;
}
std::string TomlTable::choice_or(std::string_view key, const std::string& fallback,
                                 const std::vector<std::string>& allowed) const {
  state_->note(key, "text", {}, allowed);
  state_->note_fallback(key, toml_quoted(fallback));
  return has(key) ? choice(key, allowed) : fallback;
}

void TomlTable::fail(std::string_view key, const std::string& problem, const std::string& mend) const {
  state_->fail(key.empty() ? nullptr : state_->table->get(key), key, problem, mend);
}

void TomlTable::fail_at(std::string_view key, std::size_t index, const std::string& problem,
                        const std::string& mend) const {
  const toml::node* list = state_->table->get(key);
  const toml::node* element = list && list->is_array() ? list->as_array()->get(index) : list;
  state_->fail(element, std::string(key) + "[" + std::to_string(index) + "]", problem, mend);
}

std::map<std::string, AskedKey> TomlTable::asked() const {
  std::map<std::string, AskedKey> out;
  state_->collect(out);
  return out;
}

void TomlTable::finish() const { state_->finish(); }

TomlTable parse_toml(std::string_view text, const std::string& name) {
  check_toml_text(text, name);
  auto state = std::make_shared<TomlTable::State>();
  try {
    state->root = std::make_shared<const toml::table>(toml::parse(text, name));
  } catch (const toml::parse_error& error) {
    throw Error(place_of(name, error.source()), std::string(error.description()),
                "mend the TOML syntax at this place");
  }
  state->table = state->root.get();
  state->file = name;
  return TomlTable(state);
}

std::string toml_quoted(std::string_view text) {
  std::string quoted = "\"";
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      quoted += '\\';
      quoted += c;
    } else if (byte < 0x20 || byte == 0x7f) {
      quoted += fmt::format("\\u{:04X}", byte);
    } else {
      quoted += c;
    }
  }
  return quoted + "\"";
}

}  // namespace base
