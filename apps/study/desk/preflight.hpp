#pragma once
/// What is looked at before a participant begins: lines that say ok, warn or unknown.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace apps {

/// Of the participant's window.
struct ScreenFacts {
  double told_hz = 0;      ///< by the system; 0: nothing
  double measured_hz = 0;  ///< 0: swaps do not wait for the screen
  std::optional<bool> compositor;
  bool software_gl = false;
};

/// Of the computer.
struct StationFacts {
  std::vector<std::string> governors;                ///< of the processors' frequency; empty: not told
  std::optional<std::uint64_t> free_disk_bytes;      ///< beside the database
  std::optional<double> gpu_clock_mhz, gpu_max_mhz;  ///< told by nvidia-smi
  std::optional<bool> on_battery;
};

enum class Readiness { Ok, Warn, Unknown };

struct PreflightLine {
  Readiness readiness = Readiness::Unknown;
  std::string what, finding;
};

/// Reads what the system tells; what it does not tell stays empty.
StationFacts read_station(const std::filesystem::path& database);

/// needed_bytes: what the session will write, about. A pure function.
std::vector<PreflightLine> judge_preflight(const std::optional<ScreenFacts>& screen,
                                           const StationFacts& station, std::uint64_t needed_bytes);

/// "ok       refresh rate: 60 Hz" and so on, a line each.
std::string format_preflight(const std::vector<PreflightLine>& lines);

}  // namespace apps
