#include "libstudy/pacing/frame_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "libstudy/pacing/capture_table.hpp"
#include "libstudy/pacing/profile.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr std::array frame_columns{"MsBetweenPresents", "FrameTime", "Time (ms)", "Time(ms)"};
constexpr std::array display_columns{"MsBetweenDisplayChange", "DisplayedTime"};
constexpr std::array animation_columns{"AnimationError", "MsAnimationError"};
/// Columns that hold the time since the start of the log, and the length of their unit in ms.
constexpr std::array<std::pair<const char*, double>, 2> clock_columns{
    {{"TimeInSeconds", 1e3}, {"elapsed", 1e-6}}};
/// Least share of the time between the first and the last row that the frame times must fill.
constexpr double least_filled = 0.99;
/// The display shows a frame some frames after the program made it. By so many of the longest intervals the
/// intervals on the display may exceed the time between the first and the last row.
constexpr double frames_ahead = 4;
/// A frame rate times a frame time in ms is about 1e3. A larger product means that the time is in
/// microseconds.
constexpr double most_ms_times_fps = 3e4;

/// Columns that together name a window, and the words before their values.
constexpr std::array<std::pair<const char*, const char*>, 3> source_columns{
    {{"Application", ""}, {"ProcessID", "process "}, {"SwapChainAddress", "window "}}};

template <std::size_t N>
bool is_one_of(const std::string& name, const std::array<const char*, N>& names) {
  return std::any_of(names.begin(), names.end(),
                     [&](const char* one) { return folded_name(one) == folded_name(name); });
}

/// True for a column that holds frame rates.
bool is_rate(const std::string& column) {
  const std::string name = folded_name(column);
  for (const char* rate : {"fps", "frame_rate", "framerate", "frame rate", "refresh_rate"})
    if (name.find(rate) != std::string::npos) return true;
  return false;
}

struct Column {
  std::size_t place = 0;
  bool cumulative = false;  ///< times since the start, whose differences are the frame times
};

struct Window {
  std::vector<FrameLog> logs;                  ///< one for each column
  std::vector<std::optional<double>> last_ms;  ///< last time in each cumulative column
  double animation_sum_ms = 0;
  std::int64_t animation_rows = 0;
  std::optional<double> began_ms;  ///< time of the first row
  double ended_ms = 0;             ///< time of the last row
  std::vector<double> first_ms;    ///< by column: frame time of the first row, which may precede its time
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
    if (table_.mangohud()) fps_ = table_.place_of("fps");
    dropped_ = table_.place_of("Dropped");
    until_displayed_ = table_.place_of("MsUntilDisplayed");
    for (const auto& [name, word] : source_columns)
      if (const auto place = table_.place_of(name)) sources_.emplace_back(*place, word);
    for (const auto& [name, unit_ms] : clock_columns) {
      if (clock_) break;
      clock_ = table_.place_of(name);
      clock_unit_ms_ = unit_ms;
    }
  }

  std::vector<FrameLog> read() {
    std::vector<std::string> fields;
    while (table_.next(fields)) add_row(window_of(fields), fields);
    if (windows_.empty())
      throw base::Error(table_.file(), "names columns and holds no row", "give the log of a recording");
    std::vector<FrameLog> out;
    std::vector<std::string> remarks;
    for (Window& window : windows_) {
      for (std::size_t i = 0; i < window.logs.size(); ++i) {
        FrameLog& log = window.logs[i];
        if (log.frame_ms.size() < 2) {
          remarks.push_back(fmt::format("{}{} has fewer than two intervals in {} rows and is left out",
                                        base::shortened(log.column), of(log), window.rows));
          continue;
        }
        check_clock(window, i);
        if (log.kind == Intervals::DisplayChanges && window.animation_rows > 0) {
          log.animation_error_ms = window.animation_sum_ms / static_cast<double>(window.animation_rows);
          log.animation_rows = window.animation_rows;
        }
        if (!clock_)
          log.remarks.emplace_back("the log has no clock, so whether rows are missing is not known");
        out.push_back(std::move(log));
      }
    }
    if (out.empty())
      throw base::Error(table_.file(), "holds fewer than two frame times of each window",
                        "record for longer");
    for (FrameLog& log : out) log.cut = table_.cut();
    if (table_.cut())
      remarks.emplace_back("the last line of the file does not end, so its row may be cut and is left out");
    out.back().remarks.insert(out.back().remarks.end(), remarks.begin(), remarks.end());
    return out;
  }

 private:
  void add_column(std::size_t place) {
    const std::string& name = table_.names()[place];
    if (is_rate(name))
      table_.fail("the column " + base::shortened(name) + " holds rates, not frame times",
                  "choose a column of frame times in ms, or record each frame, for example with PresentMon");
    const std::string folded = folded_name(name);
    columns_.push_back({place, folded == "time (ms)" || folded == "time(ms)"});
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
      if (is_rate(name))
        table_.fail("has no column of frame times. " + base::shortened(name) +
                        " is a mean rate, and a mean does not determine the frame times",
                    "record each frame, for example with PresentMon");
    }
    std::string names;
    for (const std::string& name : table_.names()) names += (names.empty() ? "" : ", ") + name;
    table_.fail("has no column of frame times that is known",
                "name a column with the time of each frame in ms by --column; this file has: " +
                    base::shortened(names, 300));
  }

  Window& window_of(const std::vector<std::string>& fields) {
    std::string key, source;
    for (const auto& [place, word] : sources_) key += fields[place] + '\n';
    const auto [found, fresh] = places_.emplace(key, windows_.size());
    if (!fresh) return windows_[found->second];
    for (const auto& [place, word] : sources_)
      source += (source.empty() ? "" : ", ") + (word + base::shortened(fields[place], 40));
    Window& added = windows_.emplace_back();
    added.last_ms.resize(columns_.size());
    added.first_ms.resize(columns_.size());
    for (const Column& column : columns_) {
      FrameLog& log = added.logs.emplace_back();
      log.source = source;
      log.column = table_.names()[column.place];
      log.kind = is_one_of(log.column, display_columns)                    ? Intervals::DisplayChanges
                 : is_one_of(log.column, frame_columns) || !table_.named() ? Intervals::Frames
                                                                           : Intervals::Named;
    }
    return added;
  }

  /// True for a row whose frame the display never showed.
  bool never_shown(const std::vector<std::string>& fields) const {
    if (dropped_ && table_.number_in(fields[*dropped_]) == 1) return true;
    return until_displayed_ && folded_name(fields[*until_displayed_]) == "na";
  }

  /// The frame time of column `i` in a row; none if the row has none.
  std::optional<double> time_of(Window& window, std::size_t i, const std::vector<std::string>& fields) {
    const std::string& text = fields[columns_[i].place];
    if (columns_[i].cumulative) {
      const auto now = table_.number_in(text);
      if (!now) table_.fail("\"" + base::shortened(text, 40) + "\" is no time in ms");
      const auto before = std::exchange(window.last_ms[i], now);
      if (!before) return {};
      if (*now <= *before)
        table_.fail(fmt::format("the time goes from {:g} to {:g} ms", *before, *now),
                    "keep the rows of one recording, in their order");
      // Differences of decimal numbers are rounded to nanoseconds, which no such log resolves.
      return table_.checked_time(std::round(1e6 * (*now - *before)) / 1e6);
    }
    if (fps_ && window.rows == 0) {
      const auto time = table_.number_in(text), fps = table_.number_in(fields[*fps_]);
      microseconds_ = time && fps && *time * *fps > most_ms_times_fps;
    }
    if (microseconds_)
      if (const auto time = table_.number_in(text)) return table_.checked_time(1e-3 * *time);
    const bool changes = window.logs[i].kind == Intervals::DisplayChanges;
    const auto ms = table_.frame_time(text, window.rows == 0 || changes);
    if (ms && changes && never_shown(fields))
      table_.fail(window.logs[i].column +
                      " has an interval for a frame that was never shown, so its intervals are "
                      "not those of the display",
                  "read the frames alone: name the column MsBetweenPresents, by --column or under [frames] "
                  "of a mapping");
    return ms;
  }

  void add_row(Window& window, const std::vector<std::string>& fields) {
    for (std::size_t i = 0; i < columns_.size(); ++i) {
      FrameLog& log = window.logs[i];
      const auto ms = time_of(window, i, fields);
      if (ms) log.frame_ms.push_back(*ms);
      if (ms && window.rows == 0) window.first_ms[i] = *ms;
      log.left_out += !ms;
    }
    if (animation_) {
      // PresentMon writes values near -2^64 / 10^4 for frames that follow one that was never shown.
      const auto error_ms = table_.number_in(fields[*animation_]);
      if (error_ms && std::abs(*error_ms) <= longest_trace_ms) {
        window.animation_sum_ms += std::abs(*error_ms);
        ++window.animation_rows;
      }
    }
    if (clock_) {
      const auto now = table_.number_in(fields[*clock_]);
      if (!now || !std::isfinite(*now)) table_.fail(table_.names()[*clock_] + " is no number");
      const double now_ms = clock_unit_ms_ * *now;
      if (window.began_ms && now_ms < window.ended_ms)
        table_.fail(table_.names()[*clock_] + " goes back", "keep the rows of one recording, in their order");
      window.ended_ms = now_ms;
      if (!window.began_ms) window.began_ms = now_ms;
    }
    ++window.rows;
  }

  static std::string of(const FrameLog& log) { return log.source.empty() ? "" : " of " + log.source; }

  /// Refuses intervals that do not fill the time from the first row to the last, or exceed it. An interval on
  /// the display spans the frames that were never shown, so display intervals fill the time too.
  void check_clock(const Window& window, std::size_t i) const {
    if (!window.began_ms || window.rows < 2) return;
    const FrameLog& log = window.logs[i];
    const double filled_ms = std::accumulate(log.frame_ms.begin(), log.frame_ms.end(), -window.first_ms[i]);
    const double longest_ms = *std::max_element(log.frame_ms.begin(), log.frame_ms.end());
    const double span_ms = window.ended_ms - *window.began_ms;
    const double ahead_ms = (log.kind == Intervals::DisplayChanges ? frames_ahead : 1) * longest_ms;
    const std::string found =
        fmt::format("{}{} sums up to {:.4g} s where {:.4g} s passed", base::shortened(log.column), of(log),
                    1e-3 * filled_ms, 1e-3 * span_ms);
    if (least_filled * (filled_ms - ahead_ms) > span_ms)
      throw base::Error(table_.file(), found + ", so it does not hold frame times in ms",
                        "name a column of frame times in ms by --column");
    if (filled_ms + ahead_ms < least_filled * span_ms)
      throw base::Error(table_.file(), found + ", so the log does not hold every frame",
                        "record every frame (MangoHud: log_interval=0), and keep all rows");
  }

  CaptureTable table_;
  std::vector<Column> columns_;
  std::optional<std::size_t> animation_, fps_, dropped_, until_displayed_, clock_;
  double clock_unit_ms_ = 1;
  bool microseconds_ = false;
  std::vector<std::pair<std::size_t, std::string>>
      sources_;                                ///< columns that name the window, and their words
  std::map<std::string, std::size_t> places_;  ///< place in windows_, by the fields that name it
  std::vector<Window> windows_;
};

}  // namespace

std::vector<FrameLog> read_frame_logs(const std::filesystem::path& file, const std::string& column) {
  return FrameLogReader(file, column).read();
}

FrameLog read_frame_log(const std::filesystem::path& file, const std::string& column, Intervals preferred) {
  std::vector<FrameLog> logs = read_frame_logs(file, column);
  for (const FrameLog& log : logs)
    if (log.source != logs.front().source)
      throw base::Error(file.string(),
                        "holds frames of several windows or programs: " +
                            base::shortened(logs.front().source) + "; " + base::shortened(log.source),
                        "keep the rows of the window or run that showed the stimulus");
  const auto chosen =
      std::find_if(logs.begin(), logs.end(), [&](const FrameLog& log) { return log.kind == preferred; });
  return std::move(chosen == logs.end() ? logs.front() : *chosen);
}

PlayedTrial played_of_log(const FrameLog& log) {
  PlayedTrial played;
  double now_ms = 0;
  for (const double ms : log.frame_ms) {
    FrameRecord frame;
    frame.index = static_cast<std::int64_t>(played.frames.size());
    frame.scheduled_ns = frame.times.submitted_ns = played.end_ns;
    if (log.kind == Intervals::DisplayChanges) frame.times.actual_display_ns = played.end_ns;
    played.frames.push_back(frame);
    now_ms += ms;
    played.end_ns = std::llround(1e6 * now_ms);
  }
  return played;
}

TimingGrade grade_of_log(const FrameLog& log) {
  return log.kind == Intervals::DisplayChanges ? TimingGrade::DisplayFeedback : TimingGrade::CpuSubmit;
}

}  // namespace study
