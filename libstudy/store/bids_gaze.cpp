/// Where people looked, as BIDS 1.11 keeps it. An eye recording says whose eye and on what screen; the mouse
/// is no eye and comes at no fixed rate, so it stands as behaviour.
#include <algorithm>
#include <map>

#include "libstudy/store/bids_writer.hpp"

namespace study::bids {

using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr const char* as_share = "1";

/// When each presentation of a session began, from the first stimulus.
std::map<std::int64_t, std::int64_t> onsets_of(Connection& database, std::int64_t session) {
  Statement row(database,
                "SELECT presentation_id, start_ns, end_ns FROM presentation JOIN trial USING (trial_id) "
                "WHERE session_id = ? ORDER BY presentation_id");
  SessionTime time;
  std::map<std::int64_t, std::int64_t> onsets;
  for (row.bind_all(session); row.step();) {
    std::optional<std::int64_t> end_ns;
    if (!row.is_null(2)) end_ns = row.integer(2);
    onsets[row.integer(0)] = time.onset_of(row.integer(1), end_ns);
  }
  return onsets;
}

struct Samples {
  Table rows{{"timestamp", "x_coordinate", "y_coordinate", "valid"}};
  std::vector<std::int64_t> times_ns;
};

Samples samples_of(Connection& database, std::int64_t session, const char* source) {
  const auto onsets = onsets_of(database, session);
  Statement row(database,
                "SELECT presentation_id, sampled_ns, x, y, valid FROM gaze JOIN presentation USING "
                "(presentation_id) JOIN trial USING (trial_id) WHERE session_id = ? AND source = ? "
                "ORDER BY presentation_id, sample_index");
  Samples samples;
  for (row.bind_all(session, source); row.step();) {
    const std::int64_t at_ns = onsets.at(row.integer(0)) + row.integer(1);
    samples.times_ns.push_back(at_ns);
    samples.rows.push_back({seconds(at_ns), field(row, 2), field(row, 3), field(row, 4)});
  }
  return samples;
}

/// Of the usual interval: between two stimuli nothing is recorded.
double rate_hz(const std::vector<std::int64_t>& times_ns) {
  std::vector<std::int64_t> gaps;
  for (std::size_t i = 1; i < times_ns.size(); ++i) {
    if (times_ns[i] > times_ns[i - 1]) gaps.push_back(times_ns[i] - times_ns[i - 1]);
  }
  if (gaps.empty()) return 0;
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return 1e9 / static_cast<double>(*middle);
}

Json columns(const std::string& what) {
  return {
      {"timestamp", described("when the sample came, on the time scale of the events' onset; between two "
                              "stimuli nothing is recorded",
                              "s")},
      {"x_coordinate", described(what + " from the left edge, as a share of the picture's width", as_share)},
      {"y_coordinate", described(what + " from the top edge, as a share of the picture's height", as_share)},
      {"valid", described("1: the source knew where; 0: it did not, as in a blink or off the picture")}};
}

void write_eye(const Samples& samples, const std::string& stem, Writer& writer) {
  const std::string name = stem + "_recording-eye1_physio";
  writer.compressed_table(name + ".tsv.gz", samples.rows);
  Json json{{"PhysioType", "eyetrack"},
            {"RecordedEye", "cyclopean"},
            {"SampleCoordinateSystem", "gaze-on-screen"},
            {"SamplingFrequency", rate_hz(samples.times_ns)},
            {"StartTime", static_cast<double>(samples.times_ns.front()) / 1e9},
            {"Columns", samples.rows.front()}};
  json.update(columns("gaze"));
  writer.json(name + ".json", json);
}

void write_mouse(const Samples& samples, const std::string& stem, Writer& writer) {
  const std::string name = stem + "_acq-mouse_beh";
  writer.table(name + ".tsv", samples.rows);
  Json json{{"Description",
             "the pointer of the mouse over the picture, at the start of each stimulus and whenever "
             "it moved. No eye was recorded: people often look where the mouse is not"}};
  json.update(columns("pointer"));
  writer.json(name + ".json", json);
}

}  // namespace

void write_gaze(Connection& database, const LabelledSession& session, Writer& writer) {
  const Samples eye = samples_of(database, session.id, "tracker");
  if (!eye.times_ns.empty()) write_eye(eye, stem_of(session), writer);
  const Samples mouse = samples_of(database, session.id, "mouse");
  if (!mouse.times_ns.empty()) write_mouse(mouse, stem_of(session), writer);
}

}  // namespace study::bids
