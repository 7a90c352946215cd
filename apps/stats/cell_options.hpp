#pragma once
/// Options of commands whose calculation can run in parts: --list, --cell and the command `merge`
/// (libstudy/analysis/shards.hpp).

#include <CLI/CLI.hpp>

#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "libstudy/analysis/shards.hpp"

namespace apps {

struct CellOptions {
  bool list = false;
  std::string cell;                           ///< key of --cell; empty: not given
  std::string shards_in;                      ///< file with names of further shards; empty: not given
  std::vector<std::filesystem::path> shards;  ///< of `merge`; empty: not given
};

/// Adds --list and --cell, which needs `out`. `results`: options of files that neither of them writes.
void add_cells(CLI::App& command, CellOptions& cells, CLI::Option* out,
               const std::vector<const char*>& results);

/// Adds the command `merge`: the options that `add` adds, then the shards. The command must call
/// read_shard_names().
CLI::App* add_merge(CLI::App& command, CellOptions& cells, const std::function<void(CLI::App&)>& add);
/// The same for commands that read a database, which is given first or as --db. The command must call
/// take_database() before read_shard_names().
CLI::App* add_merge(CLI::App& command, CellOptions& cells, std::string& database,
                    const std::function<void(CLI::App&)>& add);
/// Takes the database from the front of the shards unless --db named it. CLI::RequiredError without one.
void take_database(CellOptions& cells, std::string& database);
/// Adds the shards that --shards-in names. CLI::RequiredError if there is no shard; base::Error if the file
/// cannot be read.
void read_shard_names(CellOptions& cells);

/// Prints the key and the words of each cell.
template <class Listed>
void print_cells(const std::vector<Listed>& cells) {
  for (const study::ListedCell& cell : cells) std::printf("%s %s\n", cell.key.c_str(), cell.words.c_str());
}

/// base::Error if an output would overwrite the file `input`. `outputs`: path by option. `problem`: "is a
/// shard that is to be joined".
void check_kept(const std::filesystem::path& input, const char* problem,
                const std::map<std::string, std::string>& outputs);
/// check_kept() for each shard and for the file of --shards-in.
void check_shards_kept(const CellOptions& cells, const std::map<std::string, std::string>& outputs);

}  // namespace apps
