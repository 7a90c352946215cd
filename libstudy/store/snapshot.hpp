#pragma once
/// A database read where SQLite may write nothing beside it.

#include <filesystem>
#include <memory>

#include "libstudy/store/sqlite.hpp"

namespace study {

/// A temporary copy of a file together with its log and journal, as SQLite recovers it. For read-only media
/// and folders, where SQLite can make neither the shared memory of a log nor undo a journal. base::Error when
/// it cannot be read, or is written to all the while.
std::unique_ptr<sqlite::Connection> snapshot(const std::filesystem::path& path);

}  // namespace study
