/// Any bytes as a table in a CSV file: refused with base::Error, or read. A table that was read is the same
/// after it is written with every field in quotes and read again.

#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "stats/base/csv.hpp"
#include "stats/base/error.hpp"

namespace {

std::string in_quotes(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) {
    line += line.empty() ? "\"" : ",\"";
    for (const char c : field) line += c == '"' ? std::string("\"\"") : std::string(1, c);
    line += '"';
  }
  return line + "\n";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const base::CsvTable table("fuzz", std::string(reinterpret_cast<const char*>(data), size));
    std::string text = in_quotes(table.columns());
    for (const base::CsvRow& row : table.rows()) text += in_quotes(row.fields);
    const base::CsvTable again("again", text);
    if (again.columns() != table.columns() || again.rows().size() != table.rows().size()) std::abort();
    for (std::size_t i = 0; i < table.rows().size(); ++i)
      if (again.rows()[i].fields != table.rows()[i].fields) std::abort();
  } catch (const base::Error&) {
  }
  return 0;
}
