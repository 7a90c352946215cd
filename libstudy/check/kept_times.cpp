#include "libstudy/check/kept_times.hpp"

#include <algorithm>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"

namespace study {

namespace fs = std::filesystem;

namespace {

constexpr std::uintmax_t most_bytes = 1 << 26;

fs::path file_of(const fs::path& folder, const std::string& key) {
  return folder / ("steps-" + base::sha256_hex(key).substr(0, 32) + ".json");
}

bool is_sound(const StepTimes& times) {
  const auto good = [](const std::vector<double>& all) {
    return std::all_of(all.begin(), all.end(), [](double s) { return s >= 0 && s < 1e6; });
  };
  return !times.compute_s.empty() && times.compute_s.size() == times.draw_s.size() && good(times.compute_s) &&
         good(times.draw_s);
}

}  // namespace

std::optional<StepTimes> read_step_times(const fs::path& folder, const std::string& key) {
  const fs::path path = file_of(folder, key);
  if (folder.empty() || !fs::exists(path)) return {};
  try {
    const auto json = base::parse_json(base::read_file(path, most_bytes));
    const StepTimes times{json.at("compute_s"), json.at("draw_s")};
    if (json.at("key") == key && is_sound(times)) return times;
  } catch (const base::Json::exception&) {
  } catch (const base::Error&) {
  }
  return {};
}

void keep_step_times(const fs::path& folder, const std::string& key, const StepTimes& times) {
  if (folder.empty()) return;
  const base::Json json{{"key", key}, {"compute_s", times.compute_s}, {"draw_s", times.draw_s}};
  std::error_code ignored;
  fs::create_directories(folder, ignored);
  try {
    base::write_file_atomically(file_of(folder, key), json.dump() + "\n");
  } catch (const base::Error&) {
  }
}

}  // namespace study
