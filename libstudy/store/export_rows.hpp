#pragma once
/// Rows of the table `export`, for those who write the register and those who work it off.

#include <cstdint>
#include <string>

#include "libstudy/store/sqlite.hpp"

namespace study::export_rows {

/// Kind of a folder that was made for registered files. It holds nobody itself: it goes when it is empty.
inline constexpr const char* folder_kind = "folder";

/// Name of this computer; empty where it has none.
std::string this_host();

void strike_out(sqlite::Connection& database, std::int64_t id);

}  // namespace study::export_rows
