#include "libstudy/light/sensor_log.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string_view>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr double longest_log_s = 86400, least_interval_s = 2e-6, most_interval_s = 0.02;
constexpr double micros_wrap = 4294967296.0;  // an Arduino's micros() begins again after 2^32
constexpr std::size_t most_line = 4096, most_log_columns = 64;

struct TimeUnit {
  const char* name;
  double seconds;
  std::array<const char*, 5> words;
};
constexpr std::array log_units{TimeUnit{"s", 1, {"s", "sec", "second", "seconds", "lsl"}},
                               TimeUnit{"ms", 1e-3, {"ms", "msec", "millis", "millisecond", "milliseconds"}},
                               TimeUnit{"us", 1e-6, {"us", "micros", "usec", "microseconds", "\xC2\xB5s"}}};
constexpr std::array time_words{"time", "timestamp", "timestamps", "t", "micros", "millis", "seconds", "lsl"};
constexpr std::array trigger_words{"trigger", "trig", "ttl", "ttlin", "ttlin1", "sync", "marker", "pulse"};
constexpr std::array level_words{"level",     "light",      "photodiode", "diode",   "photo",
                                 "opto",      "opto1",      "sensor",     "voltage", "value",
                                 "luminance", "brightness", "analog",     "adc",     "photocell"};

/// The words of a column's name in lower case: "Time (ms)" has "time" and "ms".
std::vector<std::string> words_in(const std::string& name) {
  std::vector<std::string> out(1);
  for (const char c : name) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || byte >= 0x80)
      out.back() += static_cast<char>(std::tolower(byte));
    else if (!out.back().empty())
      out.emplace_back();
  }
  if (out.size() > 1 && out.back().empty()) out.pop_back();
  return out;
}

template <std::size_t N>
bool is_light_word(const std::string& word, const std::array<const char*, N>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// The unit in the name of a time column; null: it has none.
const TimeUnit* unit_in(const std::string& name) {
  const TimeUnit* found = nullptr;
  const auto words = words_in(name);
  for (const std::string& word : words)
    for (const TimeUnit& unit : log_units)
      if (is_light_word(word, unit.words)) found = &unit;
  return found;
}

const TimeUnit* unit_named(const std::string& name) {
  for (const TimeUnit& unit : log_units)
    if (name == unit.name) return &unit;
  return nullptr;
}

char separator_in(std::string_view line) {
  for (const char c : {'\t', ';', ','})
    if (line.find(c) != std::string_view::npos) return c;
  return ' ';
}

class SensorReader {
 public:
  SensorReader(const std::filesystem::path& file, const SensorChoice& choice)
      : name_(file.string()), choice_(choice), in_(file, std::ios::binary) {
    if (!in_ || !std::filesystem::is_regular_file(file))
      throw base::Error(name_, "cannot be read as a file", "give the log of the sensor");
  }

  SensorLog read() {
    std::string_view line;
    while (next_line(line) && is_comment(line)) {
    }
    if (line.empty()) throw base::Error(name_, "is empty", "give the log of the sensor");
    begin(line);
    if (!named_ && !add(line, true)) log_.remarks.emplace_back("the first line was cut and is left out");
    while (next_line(line)) {
      if (is_comment(line)) continue;
      if (ended_) {
        log_.remarks.push_back(fmt::format("line {} does not end and is left out", number_));
        break;
      }
      add(line, false);
    }
    finish();
    return std::move(log_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& mend) const {
    throw base::Error(name_ + ":" + std::to_string(number_), problem, mend);
  }

  static bool is_comment(std::string_view line) {
    return line.empty() || line.starts_with("#") || line.starts_with("//");
  }

  /// The next line without its end; empty at the end of the file. ended_: the line has no end.
  bool next_line(std::string_view& line) {
    line = {};
    if (ended_ || !std::getline(in_, text_)) return false;
    ended_ = in_.eof();
    if (text_.size() > most_line) {
      ++number_;
      fail("has more than 4096 bytes", "give a table of numbers with a line for each sample");
    }
    line = text_;
    if (number_++ == 0 && line.starts_with("\xEF\xBB\xBF")) line.remove_prefix(3);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ' || line.back() == '\t'))
      line.remove_suffix(1);
    if (const auto arrow = line.find("-> "); arrow != std::string_view::npos) line.remove_prefix(arrow + 3);
    while (!line.empty() && line.front() == ' ') line.remove_prefix(1);
    return true;
  }

  std::size_t split(std::string_view line, std::array<std::string_view, most_log_columns>& fields) const {
    std::size_t count = 0;
    while (count < most_log_columns) {
      while (separator_ == ' ' && !line.empty() && line.front() == ' ') line.remove_prefix(1);
      const std::size_t end = line.find(separator_);
      std::string_view field = line.substr(0, end);
      while (!field.empty() && (field.front() == ' ' || field.front() == '"')) field.remove_prefix(1);
      while (!field.empty() && (field.back() == ' ' || field.back() == '"')) field.remove_suffix(1);
      fields[count++] = field;
      if (end == std::string_view::npos) break;
      line.remove_prefix(end + 1);
    }
    return count;
  }

  std::optional<double> number_in(std::string_view field) const {
    std::array<char, 64> copy;
    if (field.empty() || field.size() > copy.size()) return {};
    if (field.front() == '+') field.remove_prefix(1);
    std::copy(field.begin(), field.end(), copy.begin());
    char* const end = copy.data() + field.size();
    if (separator_ != ',') std::replace(copy.data(), end, ',', '.');
    double value = 0;
    const auto [rest, error] = std::from_chars(copy.data(), end, value);
    if (error != std::errc() || rest != end || !std::isfinite(value)) return {};
    return value;
  }

  /// Reads the first line: names, or the first row of a log without names.
  void begin(std::string_view line) {
    std::string plain(line);
    std::replace(plain.begin(), plain.end(), '\t', ' ');
    if (!base::is_plain_line(plain)) fail("is no text in UTF-8", "give a table in text, as CSV");
    separator_ = separator_in(line);
    std::array<std::string_view, most_log_columns> fields;
    columns_ = split(line, fields);
    named_ = std::none_of(fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(columns_),
                          [&](std::string_view field) { return number_in(field).has_value(); });
    std::vector<std::string> names;
    for (std::size_t i = 0; named_ && i < columns_; ++i) names.emplace_back(fields[i]);
    log_.events = std::find(names.begin(), names.end(), "Opto1") != names.end() &&
                  std::find(names.begin(), names.end(), "timestamp") != names.end();
    choose_columns(names);
    choose_unit(names);
  }

  std::size_t column_of(const std::string& wanted, const std::vector<std::string>& names) const {
    const auto found = std::find(names.begin(), names.end(), wanted);
    if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
    std::size_t place = 0;
    const char* const end = wanted.data() + wanted.size();
    const auto [rest, error] = std::from_chars(wanted.data(), end, place);
    if (error == std::errc() && rest == end && place >= 1 && (place <= columns_ || !named_)) return place - 1;
    throw base::Error("--columns", "names '" + base::shortened(wanted) + "', which " + name_ + " has not",
                      "name a column of its first line, or its number from 1");
  }

  template <std::size_t N>
  static std::vector<std::size_t> places_of(const std::vector<std::string>& names,
                                            const std::array<const char*, N>& words) {
    std::vector<std::size_t> out;
    for (std::size_t i = 0; i < names.size(); ++i)
      if (is_light_word(words_in(names[i]).front(), words)) out.push_back(i);
    return out;
  }

  void choose_columns(const std::vector<std::string>& names) {
    if (!choice_.columns.empty()) {
      time_ = column_of(choice_.columns.at(0), names);
      level_ = column_of(choice_.columns.at(1), names);
      if (choice_.columns.size() > 2) trigger_ = column_of(choice_.columns.at(2), names);
      return;
    }
    if (!named_) {
      // A first line that was cut has too few fields, so the next lines say whether there is a third column.
      time_ = 0;
      level_ = 1;
      return;
    }
    const auto times = places_of(names, time_words);
    const auto triggers = places_of(names, trigger_words);
    auto levels = places_of(names, level_words);
    if (log_.events) {
      const auto opto = std::find(names.begin(), names.end(), "Opto1");
      levels = {static_cast<std::size_t>(opto - names.begin())};
    }
    const bool other = levels.empty() && times.size() == 1 && names.size() == 2 + triggers.size();
    for (std::size_t i = 0; other && i < names.size(); ++i)
      if (i != times[0] && (triggers.empty() || i != triggers[0])) levels = {i};
    if (times.size() != 1 || levels.size() != 1 || triggers.size() > 1)
      fail("does not say which columns hold the time and the level",
           "name them: --columns TIME,LEVEL, or TIME,LEVEL,TRIGGER");
    time_ = times[0];
    level_ = levels[0];
    if (!triggers.empty()) trigger_ = triggers[0];
  }

  void choose_unit(const std::vector<std::string>& names) {
    const TimeUnit* in_name = named_ ? unit_in(names.at(time_)) : nullptr;
    if (log_.events && !in_name) in_name = unit_named("ms");
    unit_ = choice_.unit.empty() ? in_name : unit_named(choice_.unit);
    if (!unit_)
      throw base::Error(name_, "does not say the unit of its times",
                        "add --unit s, ms or us, or name the column time_s, time_ms or time_us");
    if (in_name && unit_ != in_name)
      throw base::Error(
          "--unit " + choice_.unit,
          std::string("contradicts the first line of ") + name_ + ", which says " + in_name->name,
          "leave --unit out if the first line is right, or correct that line");
    const auto called = [&](std::size_t place) {
      return named_ ? "'" + names.at(place) + "'" : std::to_string(place + 1);
    };
    log_.format = std::string(log_.events ? "events of a Black Box ToolKit" : "samples") + ": time in " +
                  unit_->name + " from column " + called(time_) + ", level from column " + called(level_) +
                  (trigger_ ? ", trigger from column " + called(*trigger_) : "");
  }

  /// Adds a row. False for a first row without names that was cut.
  bool add(std::string_view line, bool first) {
    std::array<std::string_view, most_log_columns> fields;
    if (!named_ && log_.time_s.empty()) separator_ = separator_in(line);
    const std::size_t count = split(line, fields);
    const std::size_t needed = std::max({time_, level_, trigger_.value_or(0)}) + 1;
    const auto is_number = [&](std::string_view field) { return number_in(field).has_value(); };
    if (first &&
        (count < needed ||
         !std::all_of(fields.begin(), fields.begin() + static_cast<std::ptrdiff_t>(count), is_number)))
      return false;
    if (!named_ && log_.time_s.empty()) columns_ = count;
    if (!named_ && columns_ > 2 && choice_.columns.empty())
      fail("has " + std::to_string(columns_) + " columns, whose names the first line does not give",
           "say which are time, level and trigger: --columns 1,2,3");
    if (count != columns_ || count < needed)
      fail(fmt::format("has {} fields where {} belong", count, std::max(columns_, needed)),
           "give one line for each sample; decimal commas need semicolons or tabs between the columns");
    const auto value = [&](std::size_t column) {
      const auto number = number_in(fields[column]);
      if (!number) {
        fail("'" + base::shortened(std::string(fields[column])) + "' is no number",
             "give a log without missing values, or cut it before the line");
      }
      return *number;
    };
    add_row(value(time_), value(level_), trigger_ ? value(*trigger_) : 0);
    return true;
  }

  void add_row(double time, double level, double trigger) {
    if (log_.time_s.empty()) origin_ = time;
    time += wraps_ * micros_wrap;
    const bool counts_micros = !named_ && unit_ == unit_named("us");
    if (counts_micros && time < last_ - 0.5 * micros_wrap) {
      ++wraps_;
      time += micros_wrap;
    }
    if (!log_.time_s.empty() && !(time > last_))
      fail(time == last_ ? "has the time of the line before" : "goes back in time",
           "give a log whose times ascend (an Arduino's micros() instead of millis()), one recording a file");
    last_ = time;
    log_.time_s.push_back((time - origin_) * unit_->seconds);
    log_.level.push_back(static_cast<float>(level));
    if (trigger_) log_.trigger.push_back(static_cast<float>(trigger));
    if (log_.time_s.size() > most_sensor_rows)
      throw base::Error(name_, fmt::format("has more than {} rows", most_sensor_rows),
                        "cut it into parts, or record at a lower rate (1000 a second do)");
  }

  void finish() {
    const std::vector<double>& time_s = log_.time_s;
    if (time_s.size() < 2)
      throw base::Error(name_, "holds fewer than two rows", "give the log of a whole recording");
    const std::string unit = std::string(" in ") + unit_->name;
    const char* const mend = "check the unit of its times: --unit, or the name of their column";
    if (time_s.back() > longest_log_s)
      throw base::Error(
          name_, fmt::format("lasts {:.3g} hours if its times are", time_s.back() / 3600) + unit, mend);
    if (log_.events) {
      log_.interval_s = 0.25e-3;
      return;
    }
    std::vector<float> steps;
    steps.reserve(time_s.size() - 1);
    for (std::size_t i = 1; i < time_s.size(); ++i)
      steps.push_back(static_cast<float>(time_s[i] - time_s[i - 1]));
    const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
    std::nth_element(steps.begin(), middle, steps.end());
    log_.interval_s = 1e-9 * std::round(1e9 * static_cast<double>(*middle));
    if (log_.interval_s < least_interval_s || log_.interval_s > most_interval_s)
      throw base::Error(
          name_, fmt::format("has samples {:.3g} s apart if its times are", log_.interval_s) + unit, mend);
    const double gap_s = std::max(5 * log_.interval_s, 0.01);
    for (std::size_t i = 1; i < time_s.size(); ++i)
      if (time_s[i] - time_s[i - 1] >= gap_s) log_.gaps.push_back({time_s[i - 1], time_s[i]});
  }

  std::string name_;
  const SensorChoice& choice_;
  std::ifstream in_;
  std::string text_;
  int number_ = 0;
  bool ended_ = false, named_ = false;
  char separator_ = ',';
  std::size_t columns_ = 0, time_ = 0, level_ = 1;
  std::optional<std::size_t> trigger_;
  const TimeUnit* unit_ = nullptr;
  double origin_ = 0, last_ = 0;
  int wraps_ = 0;
  SensorLog log_;
};

}  // namespace

SensorLog read_sensor_log(const std::filesystem::path& file, const SensorChoice& choice) {
  if (choice.columns.size() == 1 || choice.columns.size() > 3)
    throw base::Error("--columns", "names " + std::to_string(choice.columns.size()) + " columns",
                      "name two or three: TIME,LEVEL or TIME,LEVEL,TRIGGER");
  SensorLog log = SensorReader(file, choice).read();
  log.sha256 = base::sha256_of_file(file);
  return log;
}

}  // namespace study
