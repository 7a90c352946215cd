#pragma once
/// Reads a database in a folder that SQLite cannot write.

#include <filesystem>
#include <memory>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// A temporary copy of a file with its log and journal, as recovered by SQLite. For read-only media and
/// folders, where SQLite can neither make a log's shared memory nor roll back a journal. base::Error if it
/// cannot be read, or is being written all the time.
std::unique_ptr<sqlite::Connection> snapshot(const std::filesystem::path& path);

}  // namespace study
