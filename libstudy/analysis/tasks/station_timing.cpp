#include "libstudy/analysis/tasks/station_timing.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace study {

namespace {

/// |realised - planned| over showings: mean and largest; null if there are none.
struct Distance {
  int count = 0;
  double sum = 0, largest = 0;
  void add(double distance) {
    ++count;
    sum += distance;
    largest = std::max(largest, distance);
  }
  Json mean() const { return count > 0 ? Json(sum / count) : Json(); }
  Json worst() const { return count > 0 ? Json(largest) : Json(); }
};

struct StationTiming {
  std::int64_t showings = 0, pass = 0, degraded = 0, fail = 0, unjudged = 0, framed = 0, late = 0;
  std::map<std::string, std::int64_t> grades;
  Distance mean, sd;  ///< over showings with a planned rate and a known one
  double longest_ms = 0;

  void add(const TaskShowing& shown, FpsMean kind) {
    ++showings;
    if (!shown.verdict)
      ++unjudged;
    else
      ++(*shown.verdict == Verdict::Pass ? pass : *shown.verdict == Verdict::Degraded ? degraded : fail);
    if (shown.nominal.mean > 0 && shown.has_rates()) {
      mean.add(std::abs(shown.realised.mean_of(kind) - shown.nominal.mean));
      sd.add(std::abs(shown.realised.sd - shown.nominal.sd));
    }
    if (!shown.framed) return;
    ++framed;
    ++grades[std::string(1, static_cast<char>(shown.grade))];
    longest_ms = std::max(longest_ms, shown.longest_ms);
    late += shown.late;
  }
};

}  // namespace

Json station_timing_json(const TaskData& data) {
  const FpsMean kind = data.protocol.whole ? data.protocol.whole->pacing.mean : FpsMean::Harmonic;
  std::map<std::string, StationTiming> stations;
  for (const TimedShowing& one : data.showings) stations[one.station].add(one.shown, kind);
  Json list = Json::array();
  if (stations.size() < 2) return list;
  for (const auto& [name, one] : stations) {
    Json json{{"task", task_name(data.task)},
              {"station", name},
              {"showings", one.showings},
              {"pass", one.pass},
              {"degraded", one.degraded},
              {"fail", one.fail},
              {"unjudged", one.unjudged},
              {"grades", one.grades},
              {"mean_error_fps", one.mean.mean()},
              {"mean_error_worst_fps", one.mean.worst()},
              {"sd_error_fps", one.sd.mean()},
              {"sd_error_worst_fps", one.sd.worst()},
              {"late_frames", one.framed > 0 ? Json(one.late) : Json()},
              {"longest_ms", one.framed > 0 ? Json(one.longest_ms) : Json()}};
    list.push_back(std::move(json));
  }
  return list;
}

}  // namespace study
