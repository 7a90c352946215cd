#include "libstudy/console/preflight.hpp"
#include "stats/base/text.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

namespace study {

namespace fs = std::filesystem;

namespace {

std::string first_word(const fs::path& file) {
  std::ifstream in(file);
  std::string word;
  in >> word;
  return word;
}

std::vector<std::string> read_governors() {
  std::vector<std::string> found;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/sys/devices/system/cpu", ignored)) {
    const std::string word = first_word(entry.path() / "cpufreq/scaling_governor");
    if (!word.empty() && std::find(found.begin(), found.end(), word) == found.end()) found.push_back(word);
  }
  return found;
}

/// True if the mains supply is offline; none if the system lists no mains supply.
std::optional<bool> read_battery() {
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator("/sys/class/power_supply", ignored)) {
    if (first_word(entry.path() / "type") == "Mains") return first_word(entry.path() / "online") == "0";
  }
  return {};
}

void read_gpu(StationFacts& facts) {
  FILE* pipe =
      popen("nvidia-smi --query-gpu=clocks.sm,clocks.max.sm --format=csv,noheader,nounits 2>/dev/null", "r");
  if (!pipe) return;
  double now = 0, most = 0;
  if (std::fscanf(pipe, "%lf , %lf", &now, &most) == 2) {
    facts.gpu_clock_mhz = now;
    facts.gpu_max_mhz = most;
  }
  pclose(pipe);
}

PreflightLine judge_refresh(const std::optional<ScreenFacts>& screen) {
  const std::string what = "refresh rate";
  if (!screen) return {Readiness::Unknown, what, "no window"};
  if (screen->measured_hz == 0)
    return {Readiness::Warn, what,
            "swaps do not wait for the screen: switch on vertical synchronisation in the driver"};
  if (screen->reported_hz == 0)
    return {Readiness::Unknown, what,
            fmt::format("measured {:.3f} Hz, the system reports none", screen->measured_hz)};
  const bool same = std::abs(screen->measured_hz / screen->reported_hz - 1) < 0.005;
  return {same ? Readiness::Ok : Readiness::Warn, what,
          fmt::format("{}{:.4g} Hz, {}measured {:.3f} Hz", same ? "" : "reported ", screen->reported_hz,
                      same ? "" : "but ", screen->measured_hz)};
}

PreflightLine judge_compositor(const std::optional<ScreenFacts>& screen) {
  if (!screen || !screen->compositor) return {Readiness::Unknown, "compositor", "cannot be detected here"};
  if (*screen->compositor)
    return {Readiness::Warn, "compositor",
            "runs: it may add a frame of delay; switch it off for full-screen windows"};
  return {Readiness::Ok, "compositor", "none"};
}

PreflightLine judge_governor(const StationFacts& station) {
  if (station.governors.empty()) return {Readiness::Unknown, "power governor", "not reported by the system"};
  const std::string all = base::joined(station.governors);
  if (all == "performance") return {Readiness::Ok, "power governor", all};
  return {Readiness::Warn, "power governor", all + ": set it to performance for steady frame times"};
}

PreflightLine judge_disk(const StationFacts& station, std::uint64_t needed_bytes) {
  if (!station.free_disk_bytes) return {Readiness::Unknown, "free disk", "not known"};
  const double free_mb = 1e-6 * static_cast<double>(*station.free_disk_bytes);
  const double needed_mb = 1e-6 * static_cast<double>(needed_bytes);
  // Requires ten times the estimate: the database's write-ahead log alone can grow as large as the database.
  const bool enough = *station.free_disk_bytes / 10 >= needed_bytes;
  return {enough ? Readiness::Ok : Readiness::Warn, "free disk",
          fmt::format("{:.0f} MB, the session writes about {:.0f} MB{}", free_mb, needed_mb,
                      enough ? "" : ": free ten times as much")};
}

PreflightLine judge_gpu(const StationFacts& station) {
  if (!station.gpu_clock_mhz || !station.gpu_max_mhz)
    return {Readiness::Unknown, "GPU clock", "nvidia-smi does not report it"};
  return {Readiness::Ok, "GPU clock",
          fmt::format("{:.0f} of {:.0f} MHz now, at rest", *station.gpu_clock_mhz, *station.gpu_max_mhz)};
}

}  // namespace

StationFacts read_station(const fs::path& database) {
  StationFacts facts;
  facts.governors = read_governors();
  facts.on_battery = read_battery();
  std::error_code error;
  const fs::path folder = fs::absolute(database, error).parent_path();
  const fs::space_info space = fs::space(folder, error);
  if (!error) facts.free_disk_bytes = space.available;
  read_gpu(facts);
  return facts;
}

std::vector<PreflightLine> judge_preflight(const std::optional<ScreenFacts>& screen,
                                           const StationFacts& station, std::uint64_t needed_bytes) {
  std::vector<PreflightLine> lines{judge_refresh(screen)};
  lines.push_back({Readiness::Unknown, "variable refresh (VRR)",
                   "make sure that it is off in the display and the driver"});
  lines.push_back(judge_compositor(screen));
  if (screen && screen->software_gl)
    lines.push_back({Readiness::Warn, "graphics", "drawn by the CPU: frames will be late"});
  lines.push_back(judge_governor(station));
  if (station.on_battery)
    lines.push_back({*station.on_battery ? Readiness::Warn : Readiness::Ok, "power",
                     *station.on_battery ? "on battery: plug it in" : "plugged in"});
  lines.push_back(judge_gpu(station));
  lines.push_back(judge_disk(station, needed_bytes));
  return lines;
}

std::string format_preflight(const std::vector<PreflightLine>& lines) {
  std::string out;
  for (const PreflightLine& line : lines) {
    const char* word = line.readiness == Readiness::Ok     ? "ok       "
                       : line.readiness == Readiness::Warn ? "warn     "
                                                           : "unknown  ";
    out += word + line.what + ": " + line.finding + "\n";
  }
  return out;
}

}  // namespace study
