#include "libstudy/pacing/capture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <sstream>
#include <utility>

#include "libstudy/pacing/profile.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"
#include "stats/fps_window.hpp"

namespace study {

namespace {

constexpr std::size_t most_capture_bytes = 1 << 28;
constexpr double slow_share = 0.05;  // share of the frames, the slowest: their mean rate is the "5 % low"

std::string folded_name(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

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
  for (const char c : {'\t', ';'})
    if (line.find(c) != std::string::npos) return c;
  return ',';
}

class CaptureReader {
 public:
  CaptureReader(const std::filesystem::path& file, const std::string& column)
      : file_(file.string()), wanted_(column), lines_(base::read_file(file, most_capture_bytes)) {}

  FrameCapture read() {
    std::string line;
    while (next(line)) {
      if (names_.empty()) {
        if (line.starts_with("//") || line.starts_with("#")) continue;
        read_head(line);
        if (named_) continue;
      }
      read_row(line);
    }
    if (names_.empty()) fail("is empty, or has only comment lines");
    return std::move(out_);
  }

 private:
  /// The next line that is not blank, without a byte-order mark and the line end.
  bool next(std::string& line) {
    while (std::getline(lines_, line)) {
      if (++number_ == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (!trimmed(line).empty()) return true;
    }
    return false;
  }

  [[noreturn]] void fail(const std::string& problem, const std::string& mend = capture_mend) const {
    throw base::Error(file_ + ":" + std::to_string(std::max(number_, 1)), problem, mend);
  }

  std::optional<double> number_in(std::string text) const {
    if (separator_ != ',') std::replace(text.begin(), text.end(), ',', '.');
    return base::parse_number<double>(text);
  }

  void read_head(const std::string& line) {
    separator_ = separator_of(line);
    names_ = fields_of(line, separator_);
    for (const std::string& name : names_)
      if (!base::is_plain_line(name)) fail("is no text in UTF-8");
    named_ = !number_in(names_.front());
    if (!named_) {
      if (names_.size() > 1) fail("holds numbers where the first line must name the columns");
      if (!wanted_.empty()) fail("has no names of columns", "remove --column");
      return;
    }
    column_ = chosen_column();
    out_.column = names_[column_];
    displayed_ = folded_name(out_.column).find("display") != std::string::npos;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::string name = folded_name(names_[i]);
      if (name == "processid" || name == "swapchainaddress") sources_[i] = "";
    }
  }

  std::size_t chosen_column() const {
    if (!wanted_.empty()) return place_of(wanted_).value_or(names_.size());
    if (names_.size() == 1) return 0;
    for (const char* name : {"MsBetweenPresents", "FrameTime", "MsBetweenDisplayChange"})
      if (const auto place = place_of(name)) return *place;
    fail("has no column MsBetweenPresents, FrameTime or MsBetweenDisplayChange",
         "name the column with the frame times by --column; the first column of this file is " +
             base::shortened(names_.front()));
  }

  /// The index of the column with this name; none if no column has the name. base::Error if two columns have
  /// the name, or if no column has the name in wanted_, which the user chose.
  std::optional<std::size_t> place_of(const std::string& wanted) const {
    std::optional<std::size_t> found;
    std::vector<std::string> shown;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      shown.push_back(base::shortened(names_[i]));
      if (folded_name(names_[i]) != folded_name(wanted)) continue;
      if (found) fail("names the column " + base::shortened(wanted) + " twice");
      found = i;
    }
    if (!found && wanted == wanted_)
      fail("has no column " + base::shortened(wanted), base::use_one_of(wanted, shown));
    return found;
  }

  void read_row(const std::string& line) {
    const auto fields = fields_of(line, separator_);
    if (fields.size() != names_.size())
      fail("has " + std::to_string(fields.size()) + " fields where " + std::to_string(names_.size()) +
           " belong");
    check_source(fields);
    const std::string& text = fields[column_];
    const auto value = number_in(text);
    const bool nothing = folded_name(text) == "na" || (value && *value == 0);
    const bool first = std::exchange(first_, false);
    if (nothing && (first || displayed_)) {
      ++out_.left_out;
      return;
    }
    if (!value || !(*value >= shortest_trace_ms && *value <= longest_trace_ms))
      fail(fmt::format("\"{}\" is no frame time from {:g} to {:g} ms", base::shortened(text, 40),
                       shortest_trace_ms, longest_trace_ms));
    out_.frame_ms.push_back(std::round(1e3 * *value) / 1e3);
  }

  /// Refuses a row of another process or swap chain than that of the rows before.
  void check_source(const std::vector<std::string>& fields) {
    for (auto& [place, source] : sources_) {
      if (first_) source = fields[place];
      if (source != fields[place])
        fail("is of " + names_[place] + " " + base::shortened(fields[place], 40) +
                 ", and the rows before of " + base::shortened(source, 40),
             "keep the rows of one program and one window in the file");
    }
  }

  static constexpr const char* capture_mend =
      "give a capture of PresentMon or CapFrameX, or a CSV file with one column of frame times in ms";

  std::string file_, wanted_;
  std::istringstream lines_;
  int number_ = 0;  ///< number of the last line read, from 1
  char separator_ = ',';
  std::vector<std::string> names_;
  bool named_ = false, displayed_ = false, first_ = true;
  std::size_t column_ = 0;
  /// By index of a column that names the process or the swap chain: the value that all rows must have.
  std::map<std::size_t, std::string> sources_;
  FrameCapture out_;
};

/// Keeps the first frames that together last at least `seconds`. base::Error if all frames last less.
void cut(FrameCapture& capture, double seconds, const std::string& file) {
  double time_s = 0;
  std::size_t count = 0;
  while (count < capture.frame_ms.size() && time_s < seconds) time_s += 1e-3 * capture.frame_ms[count++];
  if (time_s < seconds)
    throw base::Error(file, fmt::format("lasts {:.3f} s, and --seconds asks for {:g}", time_s, seconds),
                      "lower --seconds; a trace is repeated to the length of the stimulus");
  capture.frame_ms.resize(count);
}

}  // namespace

FrameCapture read_capture(const std::filesystem::path& file, const std::string& column,
                          std::optional<double> seconds) {
  FrameCapture out = CaptureReader(file, column).read();
  if (seconds) cut(out, *seconds, file.string());
  if (out.frame_ms.size() < 2 || out.frame_ms.size() > most_trace_frames)
    throw base::Error(
        file.string(),
        "holds " + std::to_string(out.frame_ms.size()) + " frames" +
            (seconds ? " in the time of --seconds" : ""),
        "give a capture of 2 to " + std::to_string(most_trace_frames) + " frames, or change --seconds");
  return out;
}

std::string timing_line(const FrameCapture& capture) {
  std::string out = "timing = {profile = \"trace\", frame_ms = [";
  for (std::size_t i = 0; i < capture.frame_ms.size(); ++i)
    out += (i > 0 ? ", " : "") + base::shortest(capture.frame_ms[i]);
  return out + "]}";
}

std::string describe_capture(const FrameCapture& capture) {
  std::vector<double> intervals_s;
  for (const double ms : capture.frame_ms) intervals_s.push_back(1e-3 * ms);
  const stats::FpsMoments moments = stats::fps_moments(intervals_s);
  const double duration_s = std::accumulate(intervals_s.begin(), intervals_s.end(), 0.0);
  std::sort(intervals_s.begin(), intervals_s.end(), std::greater<>());
  const auto slow = static_cast<std::size_t>(std::ceil(slow_share * static_cast<double>(intervals_s.size())));
  const double slow_s =
      std::accumulate(intervals_s.begin(), intervals_s.begin() + static_cast<std::ptrdiff_t>(slow), 0.0);
  return fmt::format("{} frames in {:.3f} s, mean {:.2f}, SD {:.2f}, 5 % low {:.2f} frames/s",
                     intervals_s.size(), duration_s, moments.mean, moments.sd,
                     static_cast<double>(slow) / slow_s);
}

}  // namespace study
