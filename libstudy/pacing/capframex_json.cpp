#include "libstudy/pacing/capframex_json.hpp"

#include <algorithm>

#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "stats/base/json_problems.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

/// A list of a million numbers takes some 8 MB in the file, and 100 MB once it is read.
constexpr std::size_t most_json_bytes = 1 << 25;
constexpr const char* frame_times = "MsBetweenPresents";

[[noreturn]] void fail_at(const std::string& place, const std::string& problem) {
  throw base::Error(place, problem,
                    "give a capture that CapFrameX saved as JSON, or the CSV file of the same recording");
}

/// A field of the CSV line. The values of a capture are numbers, truth values, null, and "NaN" as text.
std::string field_of(const base::Json& value, const std::string& place) {
  if (value.is_null() || (value.is_string() && value.get<std::string>() == "NaN")) return "NA";
  if (value.is_boolean()) return value.get<bool>() ? "1" : "0";
  if (!value.is_number())
    fail_at(place, "holds " + base::shortened(value.dump(), 40) + ", which is no number");
  return value.is_number_integer() ? std::to_string(value.get<long long>())
                                   : base::shortest(value.get<double>());
}

/// The lists of a run that hold a value for each frame, by name.
std::vector<std::string> lists_of(const base::Json& data) {
  std::vector<std::string> out;
  for (const auto& [name, list] : data.items())
    if (list.is_array() && !list.empty() && base::is_plain_line(name) &&
        name.find_first_of(",\"") == std::string::npos)
      out.push_back(name);
  return out;
}

const base::Json& data_of(const base::Json& run, const std::string& place) {
  if (!run.is_object() || !run.contains("CaptureData") || !run["CaptureData"].is_object())
    fail_at(place, "has no CaptureData");
  const base::Json& data = run["CaptureData"];
  if (!data.contains(frame_times) || !data[frame_times].is_array() || data[frame_times].empty())
    fail_at(place, std::string("has no list CaptureData.") + frame_times);
  return data;
}

std::string program_of(const base::Json& root) {
  std::string out;
  if (root.contains("Info") && root["Info"].is_object())
    for (const char* key : {"ProcessName", "GameName"})
      if (const base::Json& info = root["Info"]; out.empty() && info.contains(key) && info[key].is_string())
        out = info[key].get<std::string>();
  std::replace(out.begin(), out.end(), '"', '\'');
  return base::shortened(out, 80);
}

}  // namespace

CapFrameXLog read_capframex_json(const std::string& file, const std::string& text) {
  if (text.size() > most_json_bytes)
    fail_at(file, "has more than " + std::to_string(most_json_bytes >> 20) + " MiB");
  base::Json root;
  try {
    root = base::Json::parse(text);
  } catch (const base::JsonError& error) {
    fail_at(file, "is no whole JSON text: " + base::json_problem(error.what()));
  }
  if (!root.contains("Runs") || !root["Runs"].is_array() || root["Runs"].empty())
    fail_at(file, "is JSON without the list Runs of a capture");
  const base::Json& runs = root["Runs"];
  const auto place_of_run = [&](std::size_t i) { return file + ": run " + std::to_string(i + 1); };
  std::vector<std::string> names = lists_of(data_of(runs[0], place_of_run(0)));
  for (std::size_t i = 1; i < runs.size(); ++i) {
    const auto others = lists_of(data_of(runs[i], place_of_run(i)));
    std::erase_if(names, [&](const std::string& name) {
      return std::find(others.begin(), others.end(), name) == others.end();
    });
  }
  CapFrameXLog out;
  out.csv = "Application";
  for (const std::string& name : names) out.csv += "," + name;
  out.csv += "\n";
  const std::string program = program_of(root);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const base::Json& data = runs[i]["CaptureData"];
    const std::size_t count = out.frames.emplace_back(data[frame_times].size());
    for (const std::string& name : names)
      if (data[name].size() != count)
        fail_at(place_of_run(i), "has " + std::to_string(count) + " values of " + frame_times + " and " +
                                     std::to_string(data[name].size()) + " of " + base::shortened(name));
    const std::string run = runs.size() > 1 ? "run " + std::to_string(i + 1) : "";
    const std::string window = "\"" + program + (program.empty() || run.empty() ? "" : ", ") + run + "\"";
    for (std::size_t frame = 0; frame < count; ++frame) {
      out.csv += window;
      for (const std::string& name : names)
        out.csv += "," + field_of(data[name][frame],
                                  place_of_run(i) + ", frame " + std::to_string(frame + 1) + ", " + name);
      out.csv += "\n";
    }
  }
  return out;
}

std::string place_of_frame(const CapFrameXLog& log, std::size_t index) {
  std::size_t run = 0;
  while (run + 1 < log.frames.size() && index >= log.frames[run]) index -= log.frames[run++];
  return "run " + std::to_string(run + 1) + ", frame " + std::to_string(index + 1);
}

}  // namespace study
