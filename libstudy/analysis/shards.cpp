#include "libstudy/analysis/shards.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <set>
#include <stdexcept>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_shard_bytes = std::size_t{1} << 28, most_cells_named = 10;

std::string key_and_words(const ListedCell& cell) { return cell.key + " (" + cell.words + ")"; }

[[noreturn]] void refuse_damaged_shard(const fs::path& file) {
  throw base::Error(file.string(), "is damaged or cut short", "delete it and run its cell again");
}

Json read_one_shard(const ShardKind& kind, const fs::path& file) {
  const std::string text = base::read_file(file, most_shard_bytes), schema = kind.schema;
  if (!text.starts_with("{\"schema\":\"" + schema.substr(0, schema.find('/') + 1))) {
    throw base::Error(file.string(), "is not a shard of " + std::string(kind.command),
                      "name files that " + std::string(kind.command) + " --cell wrote");
  }
  const Json out = base::parse_json(text);
  if (!out.is_object() || !out.contains(kind.common) || !out.at(kind.common).is_object() ||
      !out.contains("outcomes"))
    refuse_damaged_shard(file);
  if (out.at("schema") != Json(schema)) {
    throw base::Error(file.string(), "was written by a newer program (" + out.at("schema").dump() + ")",
                      "use the newer vip-stats; the file was left as it is");
  }
  return out;
}

/// base::Error if the shard depends on something else than `here`. The error names the first difference.
void check_shard_common(const ShardKind& kind, const fs::path& file, const Json& there, const Json& here) {
  constexpr std::size_t longest = 80;  // of a value that the message shows
  for (const auto& [name, value] : here.items()) {
    const Json other = there.value(name, Json());
    if (other == value) continue;
    const std::string was = other.dump(), is = value.dump();
    const std::string which =
        was.size() > longest || is.size() > longest ? "" : fmt::format(" ({}, here {})", was, is);
    throw base::Error(file.string(), fmt::format("holds {} with another {}{}", kind.common, name, which),
                      "give the data and options with which its cell was run, or run the cell again");
  }
}

[[noreturn]] void refuse_missing_cells(const ShardKind& kind, const std::vector<ListedCell>& cells,
                                       const std::set<std::size_t>& there) {
  std::string names;
  std::size_t missing = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (there.contains(i)) continue;
    if (++missing <= most_cells_named) names += (names.empty() ? "" : ", ") + key_and_words(cells[i]);
  }
  if (missing > most_cells_named) names += fmt::format(" and {} more", missing - most_cells_named);
  throw base::Error(kind.command + std::string(" merge"),
                    fmt::format("{} of {} cells are missing: {}", missing, cells.size(), names),
                    "run each with --cell KEY --out SHARD, and name these files as well");
}

}  // namespace

ListedCell make_cell(const Json& common, const std::string& words) {
  return {base::sha256_hex(common.dump() + "\n" + words).substr(0, 16), words};
}

void refuse_unknown_cell(const std::string& key) {
  throw base::Error("--cell " + key, "is no cell of this calculation",
                    "copy one from --list, given with the same program, data and options");
}

void write_shard(const ShardKind& kind, const Json& common, const ListedCell& cell,
                 const std::function<Json()>& compute, const fs::path& file) {
  if (fs::exists(file) && fs::file_size(file) > 0) {
    if (read_one_shard(kind, file).value("key", Json()) == Json(cell.key)) return;
    throw base::Error(file.string(), "exists already and does not hold cell " + key_and_words(cell),
                      "name another file, or delete this one");
  }
  const Json outcomes = compute();
  const Json shard{{"schema", kind.schema},
                   {"key", cell.key},
                   {"cell", cell.words},
                   {kind.common, common},
                   {"outcomes_sha256", base::sha256_hex(outcomes.dump())},
                   {"outcomes", outcomes}};
  base::write_file_atomically(file, shard.dump() + "\n");
}

void read_shards(const ShardKind& kind, const Json& common, const std::vector<ListedCell>& cells,
                 const std::vector<fs::path>& files, const TakeOutcomes& take) {
  std::set<std::size_t> there;
  for (const auto& file : files) {
    const Json shard = read_one_shard(kind, file);
    check_shard_common(kind, file, shard.at(kind.common), common);
    const auto cell = std::ranges::find_if(
        cells, [&](const ListedCell& one) { return shard.value("key", Json()) == Json(one.key); });
    if (cell == cells.end()) {
      throw base::Error(
          file.string(),
          "holds " + shard.value("cell", Json()).dump() + ", which is no cell of this calculation",
          std::string("give ") + kind.options + " that it was run with, or leave the file out");
    }
    const Json& outcomes = shard.at("outcomes");
    if (shard.value("outcomes_sha256", Json()) != Json(base::sha256_hex(outcomes.dump())))
      refuse_damaged_shard(file);
    const auto number = static_cast<std::size_t>(cell - cells.begin());
    if (!there.insert(number).second) continue;
    try {
      take(number, outcomes);
    } catch (const std::out_of_range&) {
      refuse_damaged_shard(file);
    } catch (const Json::exception&) {
      refuse_damaged_shard(file);
    }
  }
  if (there.size() < cells.size()) refuse_missing_cells(kind, cells, there);
}

void expect_size(const Json& list, std::size_t size) {
  if (!list.is_array() || list.size() != size) throw std::out_of_range("size");
}

}  // namespace study
