#pragma once
/// Reference of all keys of a protocol file. A test compares it with the keys that the readers ask for.

#include <string>
#include <vector>

namespace study {

struct KeyReference {
  std::string table;  ///< "", "design", "block.question": the [table] or [[tables]] that holds it
  std::string key;
  std::string type;      ///< as base::AskedKey::type; several with " or "
  std::string values;    ///< range or choices; empty: any
  std::string fallback;  ///< value of an absent key; empty: the key is required
  std::string meaning;
};

const std::vector<KeyReference>& protocol_reference();

/// The reference as a page of Markdown: docs/protocol.md.
std::string protocol_reference_page();

}  // namespace study
