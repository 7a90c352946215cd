#pragma once
/// Reads tables of another program as sessions of a protocol, by a mapping.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/import/mapping.hpp"
#include "libstudy/store/imported.hpp"

namespace study {

/// What was read of one table.
struct ReadSource {
  std::filesystem::path file;
  std::string sha256;
  std::size_t rows = 0, used = 0;         ///< rows of the table, and those that the mapping's conditions take
  std::vector<std::string> left_columns;  ///< columns that the mapping does not name, which are not imported
};

struct ReadImport {
  std::vector<ReadSource> sources;
  std::vector<ImportedSession> sessions;  ///< by participant, then by visit
};

/// The tables that the user named: files as they are; of a folder all files, in its subfolders too, whose
/// name is among ImportMapping::files. base::Error for a folder without such a file, and for a missing file.
std::vector<std::filesystem::path> find_sources(const std::vector<std::filesystem::path>& named,
                                                const ImportMapping& mapping);

/// Reads the tables. Each trial is matched to the one cell of the protocol with its setting. base::Error at
/// file:line for a row that matches no cell or several, an answer that the question does not take, a trial
/// that the protocol does not show as often, an invalid participant code, a time in the future, and a frame
/// log that cannot be read; and if two tables hold the same bytes or the same visit of a person. base::Error
/// for a mapping of pairs and a protocol without them, or the reverse, for a pair that the protocol does not
/// show, and for a session without all trials of the protocol unless the mapping says how such a session
/// ended.
ReadImport read_import(const Protocol& protocol, const ImportMapping& mapping,
                       const std::vector<std::filesystem::path>& files);

}  // namespace study
