#pragma once
/// Every key of a protocol file. A test holds this against what the readers ask for.

#include <string>
#include <vector>

namespace study {

struct KeyReference {
  std::string table;  ///< "", "design", "block.question": the [table] or [[tables]] it stands in
  std::string key;
  std::string type;      ///< as base::AskedKey::type; several with " or "
  std::string values;    ///< range or choices; empty: any
  std::string fallback;  ///< for an absent key; empty: the key is needed
  std::string meaning;
};

const std::vector<KeyReference>& protocol_reference();

/// The reference as a page of Markdown: docs/protocol.md.
std::string protocol_reference_page();

}  // namespace study
