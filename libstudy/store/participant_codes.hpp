#pragma once
/// Codes that people and other programs take for another one, or for a missing value.

#include <string>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// Whether R, pandas, spreadsheets or BIDS read a code as "no value": NA, n-a, NaN, null, none, nil, missing,
/// undefined, in upper or lower case.
bool reads_as_missing(const std::string& code);

/// Whether two codes differ in case, in punctuation or in leading zeros of a number alone: P01, p01, P-01,
/// P1.
bool are_alike(const std::string& one, const std::string& other);

/// base::Error, with the mend, unless a code stands in the database or may be added: it reads as no missing
/// value, and is like none that stands there or withdrew.
void check_new_code(sqlite::Connection& database, const std::string& code);

}  // namespace study
