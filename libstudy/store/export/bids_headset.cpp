/// Headsets in BIDS 1.11: the headset's facts beside the events, head poses as motion.
#include <array>

#include "libstudy/store/export/bids_writer.hpp"

namespace study::bids {

using sqlite::Connection;
using sqlite::Statement;

namespace {

struct Channel {
  const char *name, *component, *type, *units, *meaning;
};

/// Columns of the recording, in order.
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
  const double hz = rate_hz(database, session.id, times_ns);
  if (hz == 0) return;  // no pose, or one pose on a display of unknown rate
  const std::string stem = stem_of(session, "motion") + "_tracksys-headset";
  writer.bare_table(stem + "_motion.tsv", rows);
  writer.json(stem + "_motion.json", motion_json(session, hz));
  writer.table(stem + "_channels.tsv", told);
}

}  // namespace study::bids
