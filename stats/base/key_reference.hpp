#pragma once
/// References of the keys of file formats, as pages of Markdown. Tests compare them with the keys that the
/// readers ask for (tests/common/asked_keys.hpp).

#include <string>
#include <vector>

namespace base {

struct KeyReference {
  std::string table;  ///< "", "design", "block.question": the [table] or [[tables]] that holds it
  std::string key;
  std::string type;      ///< as AskedKey::type; several with " or "
  std::string values;    ///< range or choices; empty: any
  std::string fallback;  ///< value of an absent key; empty: the key is required
  std::string meaning;
  std::string unit = {};  ///< empty: none, or the page's introduction says it
};

/// Fallback of keys that only some files need.
inline constexpr const char* where_needed = "see right";

/// Heading and text above the keys of a table.
struct TableReference {
  std::string table;
  std::string heading;
  std::string text;
};

/// A section for each table with its keys. A column of units stands there if any key has one.
std::string reference_sections(const std::vector<TableReference>& tables,
                               const std::vector<KeyReference>& keys);

}  // namespace base
