#include "apps/stats/cell_options.hpp"

#include <sstream>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

void add_cells(CLI::App& command, CellOptions& cells, CLI::Option* out,
               const std::vector<const char*>& results) {
  auto* list = command.add_flag("--list", cells.list, "Only print the key and the words of each cell");
  auto* cell = command.add_option("--cell", cells.cell, "Only run the cell of this key, into --out");
  cell->needs(out)->excludes(list);
  list->excludes(out);
  for (const char* file : results) {
    list->excludes(file);
    cell->excludes(file);
  }
}

CLI::App* add_merge(CLI::App& command, CellOptions& cells, const std::function<void(CLI::App&)>& add) {
  auto* merge = command.add_subcommand(
      "merge", "The whole calculation from the shards of its cells: the same as in one run");
  add(*merge);
  merge->add_option("shards", cells.shards, "Files that --cell wrote");
  merge->add_option("--shards-in", cells.shards_in, "Text file with the names of further shards, one a line");
  return merge;
}

CLI::App* add_merge(CLI::App& command, CellOptions& cells, std::string& database,
                    const std::function<void(CLI::App&)>& add) {
  auto* merge = add_merge(command, cells, add);
  merge->get_option("shards")->description(
      "The study's database, unless --db names it, and the files that --cell wrote");
  merge->add_option("--db", database, "The study's database");
  return merge;
}

void take_database(CellOptions& cells, std::string& database) {
  if (!database.empty()) return;
  if (cells.shards.empty()) throw CLI::RequiredError("database or --db");
  database = cells.shards.front().string();
  cells.shards.erase(cells.shards.begin());
}

void read_shard_names(CellOptions& cells) {
  constexpr std::size_t most_bytes = std::size_t{1} << 28;
  if (!cells.shards_in.empty()) {
    std::istringstream lines(base::read_file(cells.shards_in, most_bytes));
    for (std::string line; std::getline(lines, line);)
      if (!line.empty()) cells.shards.emplace_back(line);
  }
  if (cells.shards.empty()) throw CLI::RequiredError("shards");
}

void check_kept(const std::filesystem::path& input, const char* problem,
                const std::map<std::string, std::string>& outputs) {
  for (const auto& [option, path] : outputs) {
    if (!path.empty() && !input.empty() &&
        std::filesystem::weakly_canonical(path) == std::filesystem::weakly_canonical(input))
      throw base::Error(option + " " + path, problem, "give the output its own path");
  }
}

void check_shards_kept(const CellOptions& cells, const std::map<std::string, std::string>& outputs) {
  for (const auto& shard : cells.shards) check_kept(shard, "is a shard that is to be joined", outputs);
  check_kept(cells.shards_in, "holds the names of the shards", outputs);
}

}  // namespace apps
