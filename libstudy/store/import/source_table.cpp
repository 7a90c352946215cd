#include "libstudy/store/import/source_table.hpp"

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::size_t most_source_bytes = 1 << 28;

}  // namespace

SourceTable::SourceTable(const std::filesystem::path& file)
    : SourceTable(file, base::read_file(file, most_source_bytes)) {}

SourceTable::SourceTable(const std::filesystem::path& file, const std::string& text)
    : file_(file), sha256_(base::sha256_hex(text)), table_(file.string(), text) {}

std::size_t SourceTable::place_of(const std::string& column) const {
  if (const auto place = table_.find(column)) return *place;
  throw base::Error(file_.string(), "has no column " + base::shortened(column),
                    "correct the mapping: " + base::use_one_of(column, names()));
}

std::string SourceTable::place(const Row& row) const {
  return file_.string() + ":" + std::to_string(row.line);
}

}  // namespace study
