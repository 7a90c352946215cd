#include "libstudy/pacing/capture_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <utility>

#include "libstudy/pacing/profile.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::size_t most_capture_bytes = 1 << 28;

std::string trimmed(const std::string& text) {
  const std::size_t first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

/// The fields of a line, without the quotes around them.
std::vector<std::string> fields_of(const std::string& line, char separator) {
  std::vector<std::string> out(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"')
      quoted = !quoted;
    else if (c == separator && !quoted)
      out.emplace_back();
    else
      out.back() += c;
  }
  for (std::string& field : out) field = trimmed(field);
  return out;
}

char separator_of(const std::string& line) {
  std::string outside;  // what no quotes enclose
  bool quoted = false;
  for (const char c : line) {
    quoted ^= c == '"';
    if (!quoted) outside += c;
  }
  for (const char c : {'\t', ';'})
    if (outside.find(c) != std::string::npos) return c;
  return ',';
}

}  // namespace

CaptureTable::CaptureTable(const std::filesystem::path& file) : file_(file.string()), lines_(text_of(file)) {
  std::string line;
  bool more = next_line(line);
  while (more && (line.starts_with("//") || line.starts_with("#"))) more = next_line(line);
  // MangoHud writes its version and describes the computer before it names the columns.
  mangohud_ = more && (line == "v1" || line.starts_with("os,cpu,gpu"));
  while (mangohud_ && more && !line.starts_with("fps,frametime")) more = next_line(line);
  if (!more)
    fail(mangohud_ ? "has no line of MangoHud that begins with fps,frametime"
                   : "is empty, or has only comment lines");
  separator_ = separator_of(line);
  names_ = fields_of(line, separator_);
  for (const std::string& name : names_)
    if (!base::is_plain_line(name)) fail("is no text in UTF-8");
  named_ = !number_in(names_.front());
  if (!named_) {
    if (names_.size() > 1) fail("holds numbers where the first line must name the columns");
    first_row_ = std::exchange(names_, {""});
  }
  // OCAT describes the computer in the last columns of the first row. The other rows end before them.
  later_fields_ = place_of("Motherboard").value_or(names_.size());
}

/// The lines of the file, which of a JSON file are made of its lists.
std::string CaptureTable::text_of(const std::filesystem::path& file) {
  std::string text = base::read_file(file, most_capture_bytes);
  const std::size_t start = text.starts_with("\xEF\xBB\xBF") ? 3 : 0;
  if (const auto first = text.find_first_not_of(" \t\r\n", start);
      first == std::string::npos || text[first] != '{')
    return text;
  json_ = read_capframex_json(file_, text.substr(start));
  return std::exchange(json_->csv, {});
}

bool CaptureTable::next(std::vector<std::string>& fields) {
  if (first_row_.empty()) {
    std::string line;
    if (!next_line(line)) return false;
    if (lines_.eof()) {
      cut_ = true;
      return false;
    }
    if (blank_ > 0) {
      number_ = blank_;
      fail("is blank inside the table, so a row may be missing",
           "delete the line if no row is missing, or give the log of a whole recording");
    }
    fields = fields_of(line, separator_);
    // Unreal repeats the names in the last line but one. The last line describes the build.
    if (named_ && fields == names_) {
      if (folded_name(names_.front()) == "events") return false;
      fail("names the columns again", "give each recording in a file of its own");
    }
  } else {
    fields = std::exchange(first_row_, {});
  }
  const std::size_t wanted = std::exchange(first_, false) ? names_.size() : later_fields_;
  if (fields.size() != names_.size() && fields.size() != wanted)
    fail("has " + std::to_string(fields.size()) + " fields where " + std::to_string(wanted) + " belong");
  fields.resize(names_.size());
  return true;
}

std::optional<std::size_t> CaptureTable::place_of(const std::string& wanted) const {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; named_ && i < names_.size(); ++i) {
    if (folded_name(names_[i]) != folded_name(wanted)) continue;
    if (found) fail("names the column " + base::shortened(wanted) + " twice");
    found = i;
  }
  return found;
}

std::size_t CaptureTable::chosen(const std::string& wanted) const {
  if (!named_) fail("has no names of columns", "remove --column");
  if (const auto place = place_of(wanted)) return *place;
  std::vector<std::string> shown;
  for (const std::string& name : names_) shown.push_back(base::shortened(name));
  fail("has no column " + base::shortened(wanted), base::use_one_of(wanted, shown));
}

std::optional<double> CaptureTable::number_in(std::string text) const {
  if (separator_ != ',') std::replace(text.begin(), text.end(), ',', '.');
  return base::parse_number<double>(text);
}

std::optional<double> CaptureTable::frame_time(const std::string& text, bool may_lack) const {
  const auto value = number_in(text);
  if (may_lack && (folded_name(text) == "na" || (value && *value == 0))) return {};
  if (!value || !(*value >= shortest_trace_ms && *value <= longest_trace_ms))
    fail(fmt::format("\"{}\" is no frame time from {:g} to {:g} ms", base::shortened(text, 40),
                     shortest_trace_ms, longest_trace_ms));
  return value;
}

double CaptureTable::checked_time(double ms) const { return *frame_time(base::shortest(ms), false); }

void CaptureTable::fail(const std::string& problem, const std::string& mend) const {
  std::string place = file_ + ":" + std::to_string(std::max(number_, 1));
  if (json_) {
    place = file_ + ": CaptureData";
    if (number_ > 1) place = file_ + ": " + place_of_frame(*json_, static_cast<std::size_t>(number_ - 2));
  }
  throw base::Error(place, problem, mend);
}

void CaptureTable::fail(const std::string& problem) const {
  fail(problem,
       "give a log of frames in one of the formats of docs/session.md, or a CSV file with one column "
       "of frame times in ms");
}

/// Sets `line` to the next line that is not blank, without its line end, and without a byte-order mark at the
/// beginning of the file, and `blank_` to the first blank line before it. Returns false at the end of the
/// file.
bool CaptureTable::next_line(std::string& line) {
  blank_ = 0;
  while (std::getline(lines_, line)) {
    if (++number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (!trimmed(line).empty()) return true;
    if (blank_ == 0) blank_ = number_;
  }
  return false;
}

std::string folded_name(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

}  // namespace study
