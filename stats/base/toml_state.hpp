#pragma once
/// Implementation of TomlTable, for toml.cpp and toml_state.cpp.

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "stats/base/toml.hpp"
#include "stats/base/toml_parser.hpp"

namespace base {

/// "file:line:column".
std::string place_of(const std::string& file, const toml::source_region& region);

/// A number as shown in messages.
std::string shown(double value);

/// A table of the document, the keys asked for, and the child tables asked for.
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
  /// Looks up a key and records that it was asked for, which finish() checks.
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

}  // namespace base
