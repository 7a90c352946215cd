#include "libstudy/analysis/ptpe/calibration_history.hpp"

#include <sstream>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"

namespace study {

namespace {

using Json = base::Json;

constexpr std::size_t largest_record = 1 << 26;

[[noreturn]] void damaged(const std::filesystem::path& path, int line, const std::string& how) {
  throw base::Error(
      path.string() + ":" + std::to_string(line), how,
      "restore the record from a copy, or move it away to begin a new one; nothing was written");
}

/// Checks that every line is a complete JSON object and holds the SHA-256 of the line before it. Returns the
/// last line's object, or null for an empty record.
Json last_of(const std::filesystem::path& path, const std::string& record) {
  std::istringstream lines(record);
  std::string line, before;
  Json last;
  int number = 0;
  while (std::getline(lines, line)) {
    ++number;
    last = base::parse_json(line);
    if (!last.is_object() || !last.contains("file_sha256") || !last.contains("previous_sha256"))
      damaged(path, number, "does not describe a calibration");
    if (last["previous_sha256"] != (before.empty() ? "" : base::sha256_hex(before)))
      damaged(path, number, "does not follow the line before it");
    before = line;
  }
  if (!record.empty() && record.back() != '\n') damaged(path, number, "ends within a line");
  return last;
}

void add_line(std::string& record, Json entry, const std::string& text) {
  std::string before;
  if (!record.empty()) {
    const auto start = record.rfind('\n', record.size() - 2);
    before = record.substr(start == std::string::npos ? 0 : start + 1);
    before.pop_back();
  }
  entry["file"] = text;
  entry["file_sha256"] = base::sha256_hex(text);
  entry["previous_sha256"] = before.empty() ? "" : base::sha256_hex(before);
  record += entry.dump() + "\n";
}

}  // namespace

std::filesystem::path history_of(const std::filesystem::path& file) {
  return file.string() + ".history.jsonl";
}

void append_calibration(const std::filesystem::path& file, const std::string& text, const Json& entry) {
  const auto path = history_of(file);
  std::string record;
  if (std::filesystem::exists(path)) record = base::read_file(path, largest_record);
  const auto last = last_of(path, record);
  if (std::filesystem::exists(file)) {
    const auto standing = base::read_file(file, 1 << 20);
    if (last.is_null() || last["file_sha256"] != base::sha256_hex(standing))
      add_line(record, {{"recorded_utc", base::utc_now()}, {"found", true}}, standing);
  }
  Json line{{"recorded_utc", base::utc_now()}, {"found", false}};
  line.update(entry);
  add_line(record, std::move(line), text);
  base::write_file_atomically(path, record);
}

}  // namespace study
