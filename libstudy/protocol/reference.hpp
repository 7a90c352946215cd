#pragma once
/// Reference of all keys of a protocol file. A test compares the list of keys with the keys that the readers
/// look up.

#include <string>
#include <vector>

#include "stats/base/key_reference.hpp"

namespace study {

using base::KeyReference;

const std::vector<KeyReference>& protocol_reference();

/// The sections of the reference: one for each kind of table in a protocol file, with a description.
const std::vector<base::TableReference>& protocol_tables();

/// A small complete protocol of format 3, the example in protocol_reference_page().
const std::string& protocol_example();

/// The reference as a Markdown page, which is stored as docs/protocol.md.
std::string protocol_reference_page();

}  // namespace study
