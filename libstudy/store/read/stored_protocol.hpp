#pragma once
/// Reads a dataset's protocol from its database.

#include <cstdint>
#include <string>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// Parses the stored text and applies overrides. A protocol of the first format, which named no methods and
/// can no longer be parsed, is rebuilt from the tables as far as analyses need it: name, version, hash, cells
/// (without stimuli) and the questions asked about them; `participants` is 0, not known. `where` names the
/// database in messages; base::Error as parse_protocol().
Protocol stored_protocol(sqlite::Connection& database, std::int64_t protocol_id, const std::string& where);

}  // namespace study
