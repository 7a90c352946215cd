#pragma once
/// Rows of the table `export`, shared by the register and the deletion of exports.

#include <cstdint>
#include <string>

#include "libstudy/store/file/sqlite.hpp"

namespace study::export_rows {

/// Kind of a folder made for registered files. It holds no people itself and is removed when it is empty.
inline constexpr const char* folder_kind = "folder";

/// Name of this computer; empty if it has none.
std::string this_host();

void strike_out(sqlite::Connection& database, std::int64_t id);

}  // namespace study::export_rows
