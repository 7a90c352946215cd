#pragma once
/// Checked reading of TOML: every key is asked for once with its type and range; what nobody asked for is an
/// error. Errors are base::Error at file:line:column. toml++ itself is seen by toml.cpp alone.

#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace base {

/// Closed interval of allowed values.
struct Range {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};
inline constexpr Range any{};
/// Larger than zero.
inline constexpr Range positive{std::numeric_limits<double>::min()};
inline constexpr Range non_negative{0.0};

/// What a reader asked for under one key.
struct AskedKey {
  std::string type;  ///< "number", "whole number", "true or false", "text", "list of numbers", "list of
                     ///< texts", "table" or "tables"; empty: only whether the key is there
  std::optional<Range> range;        ///< of numbers
  std::vector<std::string> choices;  ///< of a text
  std::string fallback;              ///< for an absent key, as TOML writes it; empty: none
};

/// A range as messages show it: "[0, 1]", "(0, inf]".
std::string range_text(Range range);

/// A table of a TOML document. Copies share the document and the record of what was read.
class TomlTable {
 public:
  bool has(std::string_view key) const;
  /// True when the key is there and holds text: for keys that take a word or a number.
  bool is_text(std::string_view key) const;

  /// The value of a key; an error when it is absent, of another type, not finite or out of range.
  double number(std::string_view key, Range range = any) const;
  std::int64_t integer(std::string_view key, Range range = any) const;
  bool boolean(std::string_view key) const;
  std::string string(std::string_view key) const;
  /// One of the allowed words.
  std::string choice(std::string_view key, const std::vector<std::string>& allowed) const;
  /// All elements within range; exactly `size` of them unless size is 0.
  std::vector<double> numbers(std::string_view key, std::size_t size = 0, Range range = any) const;
  std::vector<std::string> strings(std::string_view key) const;
  TomlTable table(std::string_view key) const;
  /// Its keys, in the order of the file where the table stands on one line.
  std::vector<std::string> keys() const;
  /// [[key]]: an array of tables; empty when absent.
  std::vector<TomlTable> tables(std::string_view key) const;

  /// The same with a value for an absent key.
  double number_or(std::string_view key, double fallback, Range range = any) const;
  std::int64_t integer_or(std::string_view key, std::int64_t fallback, Range range = any) const;
  bool boolean_or(std::string_view key, bool fallback) const;
  std::string string_or(std::string_view key, const std::string& fallback) const;
  std::string choice_or(std::string_view key, const std::string& fallback,
                        const std::vector<std::string>& allowed) const;

  /// An error at this key (or at the table, when the key is empty) with the mend given.
  [[noreturn]] void fail(std::string_view key, const std::string& problem, const std::string& mend) const;

  /// The same at element `index` of the list or [[tables]] under this key.
  [[noreturn]] void fail_at(std::string_view key, std::size_t index, const std::string& problem,
                            const std::string& mend) const;

  /// What was asked for so far, here and below, by dotted name; all tables of a [[list]] are one, without
  /// their indices. So a reference of a format can be held against its reader.
  std::map<std::string, AskedKey> asked() const;

  /// Call once on the root, when all was read: the first key that nobody asked for is an error that names the
  /// known ones.
  void finish() const;

  struct State;
  explicit TomlTable(std::shared_ptr<State> state);

 private:
  std::shared_ptr<State> state_;
};

/// Parses text; `name` stands for the file in messages.
TomlTable parse_toml(std::string_view text, const std::string& name);
/// Reads a file of at most most_toml_bytes (toml_text.hpp).
TomlTable read_toml(const std::filesystem::path& path);

/// A TOML basic string, quoted and escaped.
std::string toml_quoted(std::string_view text);

}  // namespace base
