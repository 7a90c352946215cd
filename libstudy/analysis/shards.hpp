#pragma once
/// A long calculation in parts that can run separately, on many cores or machines: its cells, the file of one
/// cell (a shard), and the whole calculation from such files.
///
/// JSON of a shard: "schema" names the command and the format; "key" and "cell" are the cell's key and its
/// words; the member ShardKind::common holds everything that all cells depend on; "outcomes" is what the cell
/// computed, and "outcomes_sha256" the SHA-256 of its text. Reading a written double gives exactly the same
/// value.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "stats/base/json.hpp"

namespace study {

using Json = base::Json;

/// A part of a calculation.
struct ListedCell {
  std::string key;    ///< 16 hexadecimal digits: a hash of everything that the cell's outcome depends on
  std::string words;  ///< "26 participants, studies 1 to 192"
};

/// What the shards of one command have in common.
struct ShardKind {
  const char* command;  ///< "vip-stats power"
  const char* schema;   ///< "vip-power-shard/1": a name, a slash and the number of the format
  const char* common;   ///< member of what all cells depend on, a plural noun: "studies"
  const char* options;  ///< what decides which cells there are, for advice: "the --n and --studies"
};

/// `common` as in write_shard().
ListedCell make_cell(const Json& common, const std::string& words);

[[noreturn]] void refuse_unknown_cell(const std::string& key);
/// The cell with this key, of a list of ListedCell or of a class derived from it. base::Error for --cell if
/// there is none.
template <class Listed>
const Listed& find_cell(const std::vector<Listed>& cells, const std::string& key) {
  for (const Listed& cell : cells)
    if (cell.key == key) return cell;
  refuse_unknown_cell(key);
}

/// Computes the outcomes of `cell` and writes its shard, whole or not at all. Does nothing if the file
/// already holds this cell. base::Error if the file has another content; an empty file is replaced.
void write_shard(const ShardKind& kind, const Json& common, const ListedCell& cell,
                 const std::function<Json()>& compute, const std::filesystem::path& file);

/// Takes over the outcomes of cell number `cell`. base::JsonError or std::out_of_range: they are damaged.
using TakeOutcomes = std::function<void(std::size_t cell, const Json& outcomes)>;

/// Calls `take` once for each cell, in the order of the files. A cell that occurs twice counts once.
/// base::Error for a file that is no shard, is damaged, has a newer format or depends on anything else than
/// `common`; it names the file. If cells are missing, the base::Error names them.
void read_shards(const ShardKind& kind, const Json& common, const std::vector<ListedCell>& cells,
                 const std::vector<std::filesystem::path>& files, const TakeOutcomes& take);

/// std::out_of_range unless `list` is a list of this size.
void expect_size(const Json& list, std::size_t size);

}  // namespace study
