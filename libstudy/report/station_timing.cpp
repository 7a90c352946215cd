#include "libstudy/report/html.hpp"
#include "libstudy/report/sections.hpp"

namespace study::report {

namespace {

/// Beyond this number each station is a row instead of a column, so that the table fits on a page.
constexpr std::size_t most_station_columns = 8;

using Lines = std::vector<std::vector<std::string>>;

/// The heading of each figure, then each station with its figures.
Lines lines_of(const std::vector<Field>& stations) {
  Lines lines{{"Station", "Showings", "Pass", "Degraded", "Fail", "Not judged", "Grades",
               "Error of the mean rate: mean (frames/s)", "Error of the mean rate: largest",
               "Error of the <i>SD</i>: mean (frames/s)", "Error of the <i>SD</i>: largest", "Late frames",
               "Longest interval (ms)"}};
  for (const Field& one : stations)
    lines.push_back({one["station"].words().empty() ? "no name" : words(one["station"]),
                     count(one["showings"]), count(one["pass"]), count(one["degraded"]), count(one["fail"]),
                     count(one["unjudged"]), counts(one["grades"]), fixed(one["mean_error_fps"], 3),
                     fixed(one["mean_error_worst_fps"], 3), fixed(one["sd_error_fps"], 3),
                     fixed(one["sd_error_worst_fps"], 3), count(one["late_frames"]),
                     fixed(one["longest_ms"], 1)});
  return lines;
}

Lines turned(const Lines& lines) {
  Lines out(lines.front().size());
  for (const auto& line : lines)
    for (std::size_t i = 0; i < line.size(); ++i) out[i].push_back(line[i]);
  return out;
}

}  // namespace

std::string station_timing(const Field& root, const std::string& task, const std::string& title) {
  std::vector<Field> stations;
  for (const Field& one : root["timing_stations"].entries())
    if (one["task"].words() == task) stations.push_back(one);
  if (stations.empty()) return "";
  Lines lines = lines_of(stations);
  if (stations.size() <= most_station_columns) lines = turned(lines);
  Table table("Timing by station" + (title.empty() ? "" : ", " + title), lines.front());
  for (std::size_t i = 1; i < lines.size(); ++i) table.row(lines[i]);
  return table.html() +
         "<p class=\"note\">Error: distance of a showing's realised rate from the planned one, over the "
         "showings with a schedule.</p>\n";
}

}  // namespace study::report
