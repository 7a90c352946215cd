#pragma once
/// Rules of BIDS 1.11 for data sets of behaviour and gaze, from the specification's schema
/// (bids-specification, src/schema: rules/files, rules/sidecars, rules/tabular_data and rules/checks). They
/// are checked here because the public validator accepts anything in the fields of an eye recording.

#include <regex>

#include "tests/common/data_set.hpp"

namespace test {

class BidsRules {
 public:
  /// The rules that a data set breaks, one line each.
  static std::vector<std::string> broken_by(const std::filesystem::path& folder) {
    BidsRules rules(folder);
    rules.check_description();
    for (const std::string& name : rules.files_) {
      rules.check_name(name);
      if (name.ends_with("_motion.tsv"))
        rules.check_motion(name);
      else if (name.ends_with(".tsv"))
        rules.check_table(name);
      if (name.ends_with("_events.tsv")) rules.check_events(name);
      if (name.ends_with("_sessions.tsv")) rules.check_sessions(name);
      if (name.starts_with("phenotype/") && name.ends_with(".tsv")) rules.check_phenotype(name);
      if (name.ends_with("_physio.tsv.gz")) rules.check_recording(name);
    }
    rules.check_people();
    return rules.broken_;
  }

 private:
  using Json = base::Json;

  explicit BidsRules(const std::filesystem::path& folder) : folder_(folder), files_(files_below(folder)) {}

  void require(bool kept, const std::string& name, const std::string& rule) {
    if (!kept) broken_.push_back(name + ": " + rule);
  }
  std::string text(const std::string& name) const { return base::read_file(folder_ / name, 1u << 26); }
  static std::string sidecar_of(const std::string& name) { return name.substr(0, name.find('.')) + ".json"; }
  static bool is_number(const std::string& text) {
    return std::regex_match(text, std::regex("-?[0-9]+([.][0-9]+)?(e[-+]?[0-9]+)?"));
  }
  static bool positive(const Json& value) { return value.is_number() && value.get<double>() > 0; }
  static bool two_positive(const Json& value) {
    return value.is_array() && value.size() == 2 && positive(value[0]) && positive(value[1]);
  }
  static bool one_of(const Json& value, const std::set<std::string>& names) {
    return value.is_string() && names.contains(value.get<std::string>());
  }
  std::set<std::string> folders(const std::filesystem::path& in, const std::string& prefix) const {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(in)) {
      const std::string name = entry.path().filename().string();
      if (entry.is_directory() && name.starts_with(prefix)) names.insert(name);
    }
    return names;
  }
  static std::set<std::string> column(const Rows& rows, std::size_t place) {
    std::set<std::string> values;
    for (std::size_t i = 1; i < rows.size(); ++i) values.insert(rows[i].at(place));
    return values;
  }

  void check_description() {
    const std::string name = "dataset_description.json";
    const Json json = json_at(folder_ / name);
    require(json.is_object(), name, "is there and is an object");
    require(json.value("Name", "") != "", name, "Name is a text");
    require(json.value("BIDSVersion", "") == "1.11.0", name, "BIDSVersion is 1.11.0");
    require(one_of(json.value("DatasetType", Json()), {"raw", "derivative"}), name, "DatasetType");
    const Json by = json.value("GeneratedBy", Json());
    require(by.is_array() && !by.empty() && by[0].value("Name", "") != "", name, "GeneratedBy has a Name");
    require(files_.contains("README.md") || files_.contains("README"), name, "a README stands beside it");
  }

  void check_name(const std::string& name) {
    const std::string label = "[0-9a-zA-Z]+";
    const std::string session = "sub-(" + label + ")/ses-(" + label + ")/", folder = session + "beh/";
    const std::string stem = "sub-\\1_ses-\\2_task-" + label;
    const std::vector<std::string> allowed{
        "README(\\.md)?|dataset_description\\.json|participants\\.(tsv|json)",
        "phenotype/[^/]+\\.(tsv|json)",
        "code/.+",  // any name
        "sub-(" + label + ")/sub-\\1_sessions\\.(tsv|json)",
        folder + stem + "(_acq-" + label + ")?_(events|beh)\\.(tsv|json)",
        folder + stem + "(_recording-" + label + ")?_physio\\.(tsv\\.gz|json)",
        session + "motion/" + stem + "_tracksys-" + label + "_(motion\\.(tsv|json)|channels\\.tsv)"};
    for (const std::string& pattern : allowed) {
      if (std::regex_match(name, std::regex(pattern))) return;
    }
    require(false, name, "has a name that the standard does not know");
  }

  void check_table(const std::string& name) {
    const Rows rows = tsv_rows(text(name));
    if (rows.empty()) return require(false, name, "has a header line");
    const Json meaning = json_at(folder_ / sidecar_of(name));
    require(std::set<std::string>(rows[0].begin(), rows[0].end()).size() == rows[0].size(), name,
            "every column has a name of its own");
    for (const auto& row : rows) {
      require(row.size() == rows[0].size(), name, "every line has as many fields as the header");
      require(std::count(row.begin(), row.end(), "") == 0, name, "a field without a value is n/a");
    }
    for (const std::string& column : rows[0]) {
      const bool of_standard =
          column == "participant_id" || column == "session_id" ||
          (name.ends_with("_channels.tsv") &&
           one_of(column, {"name", "component", "type", "tracked_point", "units", "description"}));
      require(of_standard || (meaning.contains(column) && meaning[column].value("Description", "") != ""),
              name, "column " + column + " is described");
    }
  }

  void check_people() {
    const Rows rows = tsv_rows(text("participants.tsv"));
    require(rows[0][0] == "participant_id", "participants.tsv", "participant_id comes first");
    require(column(rows, 0) == folders(folder_, "sub-"), "participants.tsv",
            "every folder sub-* and no other");
    require(column(rows, 0).size() + 1 == rows.size(), "participants.tsv", "one line for each participant");
  }

  void check_sessions(const std::string& name) {
    const Rows rows = tsv_rows(text(name));
    require(rows[0][0] == "session_id", name, "session_id comes first");
    require(column(rows, 0) == folders((folder_ / name).parent_path(), "ses-"), name,
            "every folder ses-* and no other");
    require(rows[0][1] == "acq_time", name, "acq_time is there");
    for (const std::string& time : column(rows, 1)) {
      require(time == "n/a" || std::regex_match(time, std::regex("\\d{4}-\\d\\d-\\d\\dT\\d\\d:\\d\\d:\\d\\d"
                                                                 "([.]\\d{1,6})?Z?")),
              name, "acq_time is a date with time: " + time);
    }
  }

  void check_phenotype(const std::string& name) {
    const Rows rows = tsv_rows(text(name));
    require(rows[0][0] == "participant_id", name, "participant_id comes first");
    require(column(rows, 0) == column(tsv_rows(text("participants.tsv")), 0), name,
            "the participants of participants.tsv");
    require(column(rows, 0).size() + 1 == rows.size(), name, "one line for each participant");
  }

  void check_events(const std::string& name) {
    const Rows rows = tsv_rows(text(name));
    require(rows[0].size() > 1 && rows[0][0] == "onset" && rows[0][1] == "duration", name,
            "onset and duration come first");
    double before = -1e300;
    for (std::size_t i = 1; i < rows.size(); ++i) {
      const auto& row = rows[i];
      if (!is_number(row[0])) return require(false, name, "onset is a number");
      require(std::stod(row[0]) >= before, name, "onsets rise");
      before = std::stod(row[0]);
      require(row[1] == "n/a" || (is_number(row[1]) && std::stod(row[1]) >= 0), name,
              "duration is 0 or more");
    }
  }

  void check_recording(const std::string& name) {
    const Json json = json_at(folder_ / sidecar_of(name));
    if (!json.is_object()) return require(false, name, "has a sidecar");
    require(positive(json.value("SamplingFrequency", Json())), name, "SamplingFrequency is above 0");
    require(json.value("StartTime", Json()).is_number(), name, "StartTime is a number");
    const Json columns = json.value("Columns", Json());
    if (!columns.is_array()) return require(false, name, "Columns is a list");
    const Rows rows = tsv_rows(unzipped(folder_ / name));
    require(!rows.empty(), name, "has samples");
    for (const auto& row : rows) {
      require(row.size() == columns.size(), name, "every line has as many fields as Columns");
      for (const std::string& field : row)
        require(field == "n/a" || is_number(field), name, "no header, numbers alone: " + field);
    }
    for (const Json& column : columns)
      require(json.contains(column.text()) && json[column.text()].contains("Description"), name,
              "column " + column.dump() + " is described");
    require(one_of(json.value("PhysioType", Json()), {"generic", "eyetrack"}), name, "PhysioType");
    if (json.value("PhysioType", "") == "eyetrack") check_eye(name, json);
  }

  void check_motion(const std::string& name) {
    const Json json = json_at(folder_ / sidecar_of(name));
    require(json.value("TaskName", "") != "", name, "TaskName");
    require(positive(json.value("SamplingFrequency", Json())), name, "SamplingFrequency");
    const std::string stem = name.substr(0, name.rfind('_'));
    const Rows channels = tsv_rows(text(stem + "_channels.tsv"));
    const std::vector<std::string> first{"name", "component", "type", "tracked_point", "units"};
    require(std::equal(first.begin(), first.end(), channels[0].begin()), name, "its channels' columns");
    for (std::size_t i = 1; i < channels.size(); ++i) {
      require(one_of(channels[i][1], {"x", "y", "z", "quat_x", "quat_y", "quat_z", "quat_w", "n/a"}), name,
              "component " + channels[i][1]);
      require(one_of(channels[i][2], {"POS", "ORNT", "LATENCY", "MISC"}), name, "type " + channels[i][2]);
    }
    for (const auto& row : tsv_rows(text(name))) {
      require(row.size() + 1 == channels.size(), name, "every line has a field of each channel");
      for (const std::string& field : row)
        require(field == "n/a" || is_number(field), name, "no header, numbers alone: " + field);
    }
  }

  void check_eye(const std::string& name, const Json& json) {
    const std::vector<std::string> first{"timestamp", "x_coordinate", "y_coordinate"};
    for (std::size_t i = 0; i < first.size(); ++i) {
      require(json["Columns"].size() > i && json["Columns"][i] == first[i], name,
              first[i] + " comes in place");
      const Json units = json.value(first[i], Json::object()).value("Units", Json());
      require(units.is_string() && units != "", name, first[i] + " has Units");
    }
    require(one_of(json.value("RecordedEye", Json()), {"left", "right", "cyclopean"}), name, "RecordedEye");
    require(one_of(json.value("SampleCoordinateSystem", Json()),
                   {"gaze-on-screen", "eye-in-head", "gaze-in-world"}),
            name, "SampleCoordinateSystem");
    if (json.value("SampleCoordinateSystem", "") != "gaze-on-screen") return;
    const std::string events = name.substr(0, name.find("_recording")) + "_events.json";
    const Json screen = json_at(folder_ / events).value("StimulusPresentation", Json::object());
    require(positive(screen.value("ScreenDistance", Json())), events, "ScreenDistance in metres");
    require(two_positive(screen.value("ScreenResolution", Json())), events, "ScreenResolution in pixels");
    require(two_positive(screen.value("ScreenSize", Json())), events, "ScreenSize in metres");
    require(screen.value("ScreenOrigin", Json()) == Json({"top", "left"}), events, "ScreenOrigin");
  }

  std::filesystem::path folder_;
  std::set<std::string> files_;
  std::vector<std::string> broken_;
};

}  // namespace test
