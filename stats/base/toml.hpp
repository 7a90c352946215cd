#pragma once
/// Checked reading of TOML: the reader of a format looks up every key with its type and range. finish()
/// refuses a key that the reader did not look up. Errors are base::Error at file:line:column.

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
/// All numbers above zero, from the smallest normal double on.
inline constexpr Range positive{std::numeric_limits<double>::min()};
inline constexpr Range non_negative{0.0};

/// How a reader looked up one key.
struct AskedKey {
  std::string type;  ///< "number", "whole number", "true or false", "text", "list of numbers", "list of
                     ///< texts", "table" or "tables"; empty: the reader only asked if the key is present
  std::optional<Range> range;        ///< range of allowed numbers
  std::vector<std::string> choices;  ///< allowed texts
  std::string fallback;              ///< value of an absent key, as TOML writes it; empty: the reader gave
                                     ///< none
};

/// A range as shown in messages: "[0, 1]", "(0, inf]".
std::string range_text(Range range);

/// A table of a TOML document. Copies share the document and the record of the keys looked up.
class TomlTable {
 public:
  bool has(std::string_view key) const;
  /// True if the key is present and holds text: for keys that take a word or a number.
  bool is_text(std::string_view key) const;
  /// True if the key is present and holds a list: for keys that take a number or a vector.
  bool is_list(std::string_view key) const;

  /// The value of a key. An error if it is absent, of another type, not finite or out of range.
  double number(std::string_view key, Range range = any) const;
  std::int64_t integer(std::string_view key, Range range = any) const;
  bool boolean(std::string_view key) const;
  std::string string(std::string_view key) const;
  /// The text of a key; an error unless it is one of the words `allowed`.
  std::string choice(std::string_view key, const std::vector<std::string>& allowed) const;
  /// The numbers of a list, each within `range`. An error unless there are exactly `size` numbers; a size of
  /// 0 allows any number of them.
  std::vector<double> numbers(std::string_view key, std::size_t size = 0, Range range = any) const;
  std::vector<std::string> strings(std::string_view key) const;
  TomlTable table(std::string_view key) const;
  /// The table's keys, ordered by the position of their values in the file.
  std::vector<std::string> keys() const;
  /// [[key]]: an array of tables; empty when absent.
  std::vector<TomlTable> tables(std::string_view key) const;

  /// Return the value of the key, or `fallback` if the key is absent.
  double number_or(std::string_view key, double fallback, Range range = any) const;
  std::int64_t integer_or(std::string_view key, std::int64_t fallback, Range range = any) const;
  bool boolean_or(std::string_view key, bool fallback) const;
  std::string string_or(std::string_view key, const std::string& fallback) const;
  std::string choice_or(std::string_view key, const std::string& fallback,
                        const std::vector<std::string>& allowed) const;

  /// Throws an error at this key (or at the table, if the key is empty) with the advice `mend`.
  [[noreturn]] void fail(std::string_view key, const std::string& problem, const std::string& mend) const;

  /// Throws an error at element `index` of the list or [[tables]] under this key.
  [[noreturn]] void fail_at(std::string_view key, std::size_t index, const std::string& problem,
                            const std::string& mend) const;

  /// The keys looked up so far, in this table and its child tables, by dotted name. All tables of a [[list]]
  /// count as one, without indices. Tests use this to compare a format's reference with its reader.
  std::map<std::string, AskedKey> asked() const;

  /// Call once on the root after reading everything. Throws an error at a key that was not looked up, if
  /// there is one; the error names the known keys.
  void finish() const;

  struct State;
  explicit TomlTable(std::shared_ptr<State> state);

 private:
  std::shared_ptr<State> state_;
};

/// Parses text; messages use `name` as the file name.
TomlTable parse_toml(std::string_view text, const std::string& name);

/// A TOML basic string, quoted and escaped.
std::string toml_quoted(std::string_view text);

}  // namespace base
