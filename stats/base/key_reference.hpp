#pragma once
/// Reference pages in Markdown that list the keys of a file format. Tests compare the lists with the keys
/// that the readers of the format look up (tests/common/asked_keys.hpp).

#include <string>
#include <vector>

namespace base {

struct KeyReference {
  std::string table;  ///< "", "design", "block.question": the [table] or [[tables]] that holds the key
  std::string key;
  std::string type;      ///< kind of value, such as "number" or "text", in the words of AskedKey::type
                         ///< (toml.hpp); several are joined by " or "
  std::string values;    ///< range or choices; empty: any
  std::string fallback;  ///< value of an absent key; empty: the key is required
  std::string meaning;
  std::string unit = {};  ///< empty: no unit, or the page's introduction states it
};

/// KeyReference::fallback of a key that only some files need; the column "meaning" says which files need it.
inline constexpr const char* where_needed = "see right";

/// Heading and text above the keys of a table.
struct TableReference {
  std::string table;
  std::string heading;
  std::string text;
};

/// Markdown with a section for each table, which lists its keys. The column of units is omitted if no key has
/// a unit.
std::string reference_sections(const std::vector<TableReference>& tables,
                               const std::vector<KeyReference>& keys);

}  // namespace base
