#pragma once
/// A dataset's protocol as its database tells it.

#include <cstdint>
#include <string>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/sqlite.hpp"

namespace study {

/// From the text kept in the database, overrides included. A file of the first format, which named no methods
/// and is no longer read, is rebuilt from the tables as far as analyses need it: name, version, hash, cells
/// (without stimuli) and the questions asked about them; `participants` is 0, not known. `where` stands for
/// the database in messages; base::Error as parse_protocol().
Protocol stored_protocol(sqlite::Connection& database, std::int64_t protocol_id, const std::string& where);

}  // namespace study
