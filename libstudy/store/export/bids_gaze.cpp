/// Exports gaze and headset data to BIDS 1.11. Samples of an eye tracker become an eye recording. Positions
/// of the mouse and directions of the head are not eye data, so they become behavioural data. The headset's
/// facts are in the JSON file of the events; head poses become a motion recording.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "libstudy/store/export/bids_writer.hpp"

namespace study::bids {

using sqlite::Connection;
using sqlite::Statement;

namespace {

constexpr const char* as_share = "1";

struct Samples {
  Table rows;
  std::vector<std::int64_t> times_ns;
  bool rays =
      false;  ///< true: the coordinates are angles relative to the head; false: positions on the picture
};

const std::vector<std::string> screen_columns{"timestamp", "x_coordinate", "y_coordinate", "valid"};
const std::vector<std::string> ray_columns{"timestamp", "x_coordinate", "y_coordinate", "valid",
                                           "tracked",   "picture_x",    "picture_y"};

/// Azimuth and elevation of the direction whose x, y and z are in the columns column ... column + 2, degrees;
/// "n/a" if x is NULL.
std::pair<std::string, std::string> angles_of(const Statement& row, int column) {
  if (row.is_null(column)) return {"n/a", "n/a"};
  const double x = row.real(column), y = row.real(column + 1), z = row.real(column + 2);
  const double degree = std::numbers::pi / 180;
  return {number_text(std::atan2(x, -z) / degree), number_text(std::atan2(y, std::hypot(x, z)) / degree)};
}

Samples samples_of(Connection& database, std::int64_t session, const std::string& source) {
  const auto onsets = onsets_of(database, session);
  Statement row(database,
                "SELECT presentation_id, sampled_ns, x, y, valid, tracked, direction_x, direction_y, "
                "direction_z FROM gaze JOIN presentation USING (presentation_id) JOIN trial USING (trial_id) "
                "WHERE session_id = ? AND source = ? ORDER BY presentation_id, sample_index");
  Statement any(database,
                "SELECT 1 FROM gaze JOIN presentation USING (presentation_id) JOIN trial USING (trial_id) "
                "WHERE session_id = ? AND source = ? AND tracked IS NOT NULL LIMIT 1");
  Samples samples;
  samples.rays = source == "head" || any.bind_all(session, source).step();
  samples.rows.push_back(samples.rays ? ray_columns : screen_columns);
  for (row.bind_all(session, source); row.step();) {
    const std::int64_t at_ns = onsets.at(row.integer(0)) + row.integer(1);
    samples.times_ns.push_back(at_ns);
    const std::string x = field(row, 2), y = field(row, 3), valid = field(row, 4);
    if (samples.rays) {
      const auto [azimuth, elevation] = angles_of(row, 6);
      samples.rows.push_back({seconds(at_ns), azimuth, elevation, valid, field(row, 5), x, y});
    } else {
      samples.rows.push_back({seconds(at_ns), x, y, valid});
    }
  }
  return samples;
}

/// Adds the eye tracker's mean and largest error in the session's last passed validation.
void add_validation(Connection& database, std::int64_t session, Json& json) {
  Statement row(
      database,
      "SELECT avg(accuracy_deg), max(accuracy_deg) FROM gaze_validation WHERE session_id = ?1 AND "
      "validation = (SELECT max(validation) FROM gaze_validation WHERE session_id = ?1 AND passed)");
  row.bind_all(session);
  if (!row.step() || row.is_null(0)) return;
  json["AverageCalibrationError"] = row.real(0);
  json["MaximalCalibrationError"] = row.real(1);
  json["CalibrationUnit"] = "deg";
}

/// Adds name, source and clock of an eye tracker outside OpenXR. The session's times follow from the clock's
/// offset, which is right within half the round trip.
void add_tracker(Connection& database, std::int64_t session, Json& json) {
  Statement row(
      database,
      "SELECT device, source, max(round_trip_ns), count(*) FROM tracker_clock WHERE session_id = ?1 "
      "AND device = (SELECT device FROM tracker_clock WHERE session_id = ?1 ORDER BY "
      "tracker_clock_id DESC LIMIT 1) GROUP BY device, source");
  row.bind_all(session);
  if (!row.step()) return;
  json["ManufacturersModelName"] = row.text(0);
  json["GazeSource"] = row.text(1);
  json["ClockOffsetsMeasured"] = row.integer(3);
  json["LongestRoundTripMs"] = 1e-6 * row.real(2);
}

Json columns(const std::string& what) {
  return {
      {"timestamp", described("when the sample came, on the time scale of the events' onset; between two "
                              "stimuli nothing is recorded",
                              "s")},
      {"x_coordinate", described(what + " from the left edge, as a share of the picture's width", as_share)},
      {"y_coordinate", described(what + " from the top edge, as a share of the picture's height", as_share)},
      {"valid", described("1: the gaze point is known; 0: it is not, as in a blink or off the picture")}};
}

Json ray_columns_meaning() {
  Json json = columns("gaze");
  json["x_coordinate"] =
      described("azimuth of the gaze in the head's frame, from straight ahead to the right", "deg");
  json["y_coordinate"] =
      described("elevation of the gaze in the head's frame, from straight ahead up", "deg");
  json["tracked"] = described("1: of the tracker's usual quality; 0: sub-nominal, a guess of the runtime");
  json["picture_x"] =
      described("gaze from the left edge of the left eye's picture, as a share of its width", as_share);
  json["picture_y"] =
      described("gaze from the top edge of the left eye's picture, as a share of its height", as_share);
  return json;
}

void write_eye(Connection& database, const Samples& samples, const LabelledSession& session, Writer& writer) {
  const double hz = rate_hz(database, session.id, samples.times_ns);
  if (hz == 0) return;  // BIDS requires a sampling rate; the CSV export can still contain the samples
  const std::string name = stem_of(session) + "_recording-eye1_physio";
  writer.compressed_table(name + ".tsv.gz", samples.rows);
  Json json{{"PhysioType", "eyetrack"},
            {"RecordedEye", "cyclopean"},
            {"SampleCoordinateSystem", samples.rays ? "eye-in-head" : "gaze-on-screen"},
            {"SamplingFrequency", hz},
            {"StartTime", static_cast<double>(samples.times_ns.front()) / 1e9},
            {"Columns", samples.rows.front()}};
  add_validation(database, session.id, json);
  add_tracker(database, session.id, json);
  json.update(samples.rays ? ray_columns_meaning() : columns("gaze"));
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

/// Writes where the head's direction met the picture, as behavioural data. Head poses are in the motion
/// recording.
void write_head(const Samples& samples, const std::string& stem, Writer& writer) {
  const std::string name = stem + "_acq-head_beh";
  Table rows;  // columns of the samples without the angles, which are always straight ahead
  for (const auto& row : samples.rows) rows.push_back({row[0], row[5], row[6], row[3], row[4]});
  rows.front() = {"timestamp", "x_coordinate", "y_coordinate", "valid", "tracked"};
  writer.table(name + ".tsv", rows);
  Json json{
      {"Description",
       "where the direction of the head met the left eye's picture in each slot of the headset: the fluid "
       "followed it in the eyes' stead. No eye was recorded: people often look beside it"}};
  json.update(columns("direction of the head"));
  json["tracked"] = described("1: the head's turn was measured; 0: a guess of the runtime, or not valid");
  writer.json(name + ".json", json);
}

}  // namespace

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

double rate_hz(Connection& database, std::int64_t session, const std::vector<std::int64_t>& times_ns) {
  std::vector<std::int64_t> gaps;
  for (std::size_t i = 1; i < times_ns.size(); ++i) {
    if (times_ns[i] > times_ns[i - 1]) gaps.push_back(times_ns[i] - times_ns[i - 1]);
  }
  if (gaps.empty()) {
    Statement row(database,
                  "SELECT coalesce((SELECT coalesce(refresh_measured_hz, refresh_told_hz) FROM headset WHERE "
                  "session_id = ?1 ORDER BY headset_id DESC LIMIT 1), refresh_hz, 0) FROM session WHERE "
                  "session_id = ?1");
    return row.bind_all(session).step() ? row.real(0) : 0;
  }
  const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
  std::nth_element(gaps.begin(), middle, gaps.end());
  return 1e9 / static_cast<double>(*middle);
}

void write_gaze(Connection& database, const LabelledSession& session, Writer& writer) {
  const Samples eye = samples_of(database, session.id, "tracker");
  if (!eye.times_ns.empty()) write_eye(database, eye, session, writer);
  const Samples mouse = samples_of(database, session.id, "mouse");
  if (!mouse.times_ns.empty()) write_mouse(mouse, stem_of(session), writer);
  const Samples head = samples_of(database, session.id, "head");
  if (!head.times_ns.empty()) write_head(head, stem_of(session), writer);
}

namespace {

struct Channel {
  const char *name, *component, *type, *units, *meaning;
};

/// The columns of the motion recording, in order.
constexpr std::array channels{
    Channel{"latency", "n/a", "LATENCY", "s", "predicted display time on the scale of the events' onset"},
    Channel{"x", "x", "POS", "m", "to the right"},
    Channel{"y", "y", "POS", "m", "up"},
    Channel{"z", "z", "POS", "m", "back"},
    Channel{"quat_x", "quat_x", "ORNT", "n/a", "unit quaternion"},
    Channel{"quat_y", "quat_y", "ORNT", "n/a", "unit quaternion"},
    Channel{"quat_z", "quat_z", "ORNT", "n/a", "unit quaternion"},
    Channel{"quat_w", "quat_w", "ORNT", "n/a", "unit quaternion"},
    Channel{"place_tracked", "n/a", "MISC", "n/a", "1: the place was measured; 0: a guess, or not valid"},
    Channel{"turn_tracked", "n/a", "MISC", "n/a", "1: the turn was measured; 0: a guess, or not valid"}};

std::vector<double> column(Connection& database, const char* sql, std::int64_t session) {
  Statement row(database, sql);
  std::vector<double> values;
  for (row.bind_all(session); row.step();) values.push_back(row.real(0));
  return values;
}

Json motion_json(const LabelledSession& session, double hz) {
  return {
      {"TaskName", session.protocol},
      {"SamplingFrequency", hz},
      {"TrackingSystemName", "headset"},
      {"RecordingType", "discontinuous"},
      {"MissingValues", "n/a"},
      {"TrackedPointsCount", 1},
      {"MotionChannelCount", channels.size()},
      {"POSChannelCount", 3},
      {"ORNTChannelCount", 4},
      {"LATENCYChannelCount", 1},
      {"MISCChannelCount", 2},
      {"TaskDescription",
       "predicted place and turn of the middle between the eyes in each slot of the headset while a stimulus "
       "was on, in the room as the runtime fixed it: x right, y up, z back"}};
}

}  // namespace

Json headset_of(Connection& database, std::int64_t session) {
  Statement row(database, "SELECT * FROM headset WHERE session_id = ? ORDER BY headset_id DESC LIMIT 1");
  if (!row.bind_all(session).step()) return {};
  Json out;
  for (int i = 2; i < row.columns(); ++i) {
    if (row.is_null(i)) continue;
    Json& value = out[row.column_name(i)];
    if (row.is_text(i))
      value = row.text(i);
    else if (row.is_real(i))
      value = row.real(i);
    else
      value = row.integer(i);
  }
  out["ipd_mm"] = column(database, "SELECT ipd_mm FROM ipd WHERE session_id = ? ORDER BY ipd_id", session);
  return out;
}

void write_motion(Connection& database, const LabelledSession& session, Writer& writer) {
  const auto onsets = onsets_of(database, session.id);
  Statement row(database,
                "SELECT presentation_id, s.predicted_ns, x_m, y_m, z_m, quat_x, quat_y, quat_z, quat_w, "
                "place_tracked, turn_tracked FROM head JOIN slot s USING (presentation_id, slot_index) "
                "JOIN presentation USING (presentation_id) JOIN trial USING (trial_id) WHERE session_id = ? "
                "ORDER BY presentation_id, slot_index");
  Table rows(1), told{{"name", "component", "type", "tracked_point", "units", "description"}};
  for (const Channel& one : channels) {
    rows.front().emplace_back(one.name);
    told.push_back({one.name, one.component, one.type, "head", one.units, one.meaning});
  }
  std::vector<std::int64_t> times_ns;
  for (row.bind_all(session.id); row.step();) {
    times_ns.push_back(onsets.at(row.integer(0)) + row.integer(1));
    rows.push_back({seconds(times_ns.back())});
    for (int i = 2; i < row.columns(); ++i) rows.back().push_back(field(row, i));
  }
  if (times_ns.empty()) return;  // no head pose, as in a session without a headset
  const double hz = rate_hz(database, session.id, times_ns);
  if (hz == 0) return;  // fewer than two distinct times, and the refresh rate is not known
  const std::string stem = stem_of(session, "motion") + "_tracksys-headset";
  writer.bare_table(stem + "_motion.tsv", rows);
  writer.json(stem + "_motion.json", motion_json(session, hz));
  writer.table(stem + "_channels.tsv", told);
}

}  // namespace study::bids
