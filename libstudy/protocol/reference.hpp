#pragma once
/// Reference of all keys of a protocol file. A test compares this list with the keys that the readers ask
/// for.

#include <string>
#include <vector>

#include "stats/base/key_reference.hpp"

namespace study {

using base::KeyReference;

const std::vector<KeyReference>& protocol_reference();

/// The sections, which are the tables of a protocol, with what a table holds.
const std::vector<base::TableReference>& protocol_tables();

/// A small complete protocol of format 3, which the page shows.
const std::string& protocol_example();

/// The reference as a Markdown page, which is stored as docs/protocol.md.
std::string protocol_reference_page();

}  // namespace study
