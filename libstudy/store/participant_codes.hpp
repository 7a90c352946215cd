#pragma once
/// Codes that people or other programs could mistake for another code or a missing value.

#include <string>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// True if R, pandas, spreadsheets or BIDS read a code as "no value": NA, n-a, NaN, null, none, nil, missing,
/// undefined, in upper or lower case.
bool reads_as_missing(const std::string& code);

/// True if two codes differ only in case, punctuation or leading zeros of a number: P01, p01, P-01, P1.
bool are_alike(const std::string& one, const std::string& other);

/// base::Error, with a remedy, unless a code is in the database or may be added: it must not read as a
/// missing value or be alike to a code in the database or of a withdrawn person.
void check_new_code(sqlite::Connection& database, const std::string& code);

}  // namespace study
