#include "libstudy/pacing/frame_log.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "libstudy/pacing/capture_table.hpp"
#include "libstudy/pacing/profile.hpp"
#include "stats/base/error.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::array frame_columns{"MsBetweenPresents", "FrameTime", "Time (ms)", "Time(ms)"};
constexpr std::array display_columns{"MsBetweenDisplayChange", "DisplayedTime"};
constexpr std::array animation_columns{"AnimationError", "MsAnimationError"};
/// Columns with the time of a row since the start, and their units in ms.
constexpr std::array<std::pair<const char*, double>, 2> clock_columns{
    {{"TimeInSeconds", 1e3}, {"elapsed", 1e-6}}};
/// Least share of the time between the first and the last row that the frame times must fill.
constexpr double least_filled = 0.9;
/// A frame rate times a frame time in ms is about 1e3. A larger product means that the time is in
/// microseconds.
constexpr double most_ms_times_fps = 3e4;

struct Column {
  std::size_t place = 0;
  bool cumulative = false;  ///< times since the start, whose differences are the frame times
  double unit_ms = 1;
};

struct Window {
  std::string key;                             ///< fields that name the window
  std::vector<FrameLog> logs;                  ///< one for each column
  std::vector<std::optional<double>> last_ms;  ///< last time in each cumulative column
  double animation_sum_ms = 0;
  std::int64_t animation_count = 0;
  std::optional<double> began_ms;  ///< time of the first row
  double ended_ms = 0;             ///< time of the last row
  double first_ms = 0;             ///< frame time of the first row, which may precede its time
  std::int64_t rows = 0;
};

class FrameLogReader {
 public:
  FrameLogReader(const std::filesystem::path& file, const std::string& column) : table_(file) {
    if (!column.empty())
      add_column(table_.chosen(column));
    else if (table_.names().size() == 1)
      add_column(0);
    else
      add_usual_columns();
    for (const char* name : animation_columns)
      if (!animation_) animation_ = table_.place_of(name);
    fps_ = table_.place_of("fps");
    for (const auto& [name, unit_ms] : clock_columns)
      if (!clock_) clock_ = clock_of(name, unit_ms);
  }

  std::vector<FrameLog> read() {
    std::vector<std::string> fields;
    while (table_.next(fields)) add_row(window_of(fields), fields);
    std::vector<FrameLog> out;
    for (Window& window : windows_) {
      refuse_samples(window);
      const std::size_t before = out.size();
      for (FrameLog& log : window.logs) {
        if (log.displayed && window.animation_count > 0)
          log.animation_error_ms = window.animation_sum_ms / static_cast<double>(window.animation_count);
        if (log.frame_ms.size() >= 2) out.push_back(std::move(log));
      }
      if (out.size() == before)
        throw base::Error(table_.file(), "holds fewer than two frame times" + of(window),
                          "record for longer, or keep only the rows of the program that you study");
    }
    if (out.empty())
      throw base::Error(table_.file(), "names columns and holds no row", "give the log of a recording");
    return out;
  }

 private:
  void add_column(std::size_t place) {
    const std::string name = folded_name(table_.names()[place]);
    columns_.push_back({place, name == "time (ms)" || name == "time(ms)", 1});
  }

  std::optional<Column> clock_of(const char* name, double unit_ms) const {
    const auto place = table_.place_of(name);
    return place ? std::optional(Column{*place, true, unit_ms}) : std::nullopt;
  }

  template <std::size_t N>
  void add_first_of(const std::array<const char*, N>& names) {
    for (const char* name : names)
      if (const auto place = table_.place_of(name)) return add_column(*place);
  }

  void add_usual_columns() {
    add_first_of(frame_columns);
    add_first_of(display_columns);
    if (!columns_.empty()) return;
    for (const std::string& name : table_.names()) {
      const std::string folded = folded_name(name);
      if (folded.find("frame_rate") != std::string::npos || folded.find("framerate") != std::string::npos)
        table_.fail("has no column of frame times. " + base::shortened(name) +
                        " is a mean rate, and a mean does not determine the frame times",
                    "record each frame, for example with PresentMon");
    }
    table_.fail("has no column of frame times that is known",
                "name the column with the frame times in ms by --column; the first column of this file is " +
                    base::shortened(table_.names().front()));
  }

  Window& window_of(const std::vector<std::string>& fields) {
    std::string key, source;
    for (const auto& [column, word] : {std::pair{"Application", ""}, std::pair{"ProcessID", "process "},
                                       std::pair{"SwapChainAddress", "window "}}) {
      const auto place = table_.place_of(column);
      if (!place) continue;
      key += fields[*place] + '\n';
      source += (source.empty() ? "" : ", ") + (word + base::shortened(fields[*place], 40));
    }
    for (Window& window : windows_)
      if (window.key == key) return window;
    Window& added = windows_.emplace_back();
    added.key = key;
    added.last_ms.resize(columns_.size());
    for (const Column& column : columns_) {
      FrameLog& log = added.logs.emplace_back();
      log.source = source;
      log.column = table_.names()[column.place];
      log.displayed = is_displayed(log.column);
    }
    return added;
  }

  /// True for a frame time of MangoHud that is in microseconds: times the frame rate it is about 1e6, not
  /// 1e3.
  bool microseconds(const Column& column, const std::vector<std::string>& fields) const {
    if (!fps_ || folded_name(table_.names()[column.place]) != "frametime") return false;
    const auto time = table_.number_in(fields[column.place]);
    const auto fps = table_.number_in(fields[*fps_]);
    return time && fps && *time * *fps > most_ms_times_fps;
  }

  /// The frame time of column `i` in a row; none if the row has none.
  std::optional<double> time_of(Window& window, std::size_t i, const std::vector<std::string>& fields) {
    const std::string& text = fields[columns_[i].place];
    const Column& column = columns_[i];
    if (microseconds(column, fields)) return table_.checked_time(1e-3 * *table_.number_in(text));
    if (!column.cumulative) return table_.frame_time(text, window.rows == 0 || window.logs[i].displayed);
    const auto now = table_.number_in(text);
    if (!now) table_.fail("\"" + base::shortened(text, 40) + "\" is no time in ms");
    const auto before = std::exchange(window.last_ms[i], now);
    // Differences of decimal numbers are rounded to nanoseconds, which no such log resolves.
    return before ? std::optional(table_.checked_time(std::round(1e6 * (*now - *before)) / 1e6))
                  : std::nullopt;
  }

  void add_row(Window& window, const std::vector<std::string>& fields) {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      FrameLog& log = window.logs[i];
      const auto ms = time_of(window, i, fields);
      if (ms) log.frame_ms.push_back(*ms);
      if (ms && i == 0 && window.rows == 0) window.first_ms = *ms;
      log.left_out += !ms;
    }
    if (animation_) {
      // PresentMon writes values near -2^64 / 10^4 for frames that follow one that was never shown.
      const auto error_ms = table_.number_in(fields[*animation_]);
      if (error_ms && std::abs(*error_ms) <= longest_trace_ms) {
        window.animation_sum_ms += std::abs(*error_ms);
        ++window.animation_count;
      }
    }
    if (clock_) {
      if (const auto now = table_.number_in(fields[clock_->place])) {
        window.ended_ms = clock_->unit_ms * *now;
        if (!window.began_ms) window.began_ms = window.ended_ms;
      }
    }
    ++window.rows;
  }

  std::string of(const Window& window) const {
    const std::string& source = window.logs.front().source;
    return source.empty() ? "" : " of " + source;
  }

  /// Refuses a window whose frame times do not fill the time from its first to its last row.
  void refuse_samples(const Window& window) const {
    const auto& frame_ms = window.logs.front().frame_ms;
    if (!window.began_ms || window.logs.front().displayed || frame_ms.empty()) return;
    const double filled_ms = std::accumulate(frame_ms.begin(), frame_ms.end(), -window.first_ms);
    const double span_ms = window.ended_ms - *window.began_ms;
    if (filled_ms >= least_filled * span_ms) return;
    throw base::Error(
        table_.file(),
        fmt::format("holds frame times of {:.3g} s{} where {:.3g} s passed, so it does not hold every frame",
                    1e-3 * filled_ms, of(window), 1e-3 * span_ms),
        "record every frame (MangoHud: log_interval=0)");
  }

  CaptureTable table_;
  std::vector<Column> columns_;
  std::optional<std::size_t> animation_, fps_;
  std::optional<Column> clock_;
  std::vector<Window> windows_;
};

}  // namespace

std::vector<FrameLog> read_frame_logs(const std::filesystem::path& file, const std::string& column) {
  return FrameLogReader(file, column).read();
}

}  // namespace study
