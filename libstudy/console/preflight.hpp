#pragma once
/// Checks before a participant begins: lines that say ok, warn or unknown.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// Facts of the participant's window.
struct ScreenFacts {
  double reported_hz = 0;  ///< reported by the system; 0: none
  double measured_hz = 0;  ///< 0: swaps do not wait for the screen
  std::optional<bool> compositor;
  bool software_gl = false;
};

/// Facts of the computer.
struct StationFacts {
  std::vector<std::string> governors;                ///< of the processors' frequency; empty: not known
  std::optional<std::uint64_t> free_disk_bytes;      ///< beside the database
  std::optional<double> gpu_clock_mhz, gpu_max_mhz;  ///< from nvidia-smi
  std::optional<bool> on_battery;
};

enum class Readiness { Ok, Warn, Unknown };

struct PreflightLine {
  Readiness readiness = Readiness::Unknown;
  std::string what, finding;
};

/// Reads the facts from the system; unknown ones stay empty.
StationFacts read_station(const std::filesystem::path& database);

/// needed_bytes: estimate of what the session will write. A pure function.
std::vector<PreflightLine> judge_preflight(const std::optional<ScreenFacts>& screen,
                                           const StationFacts& station, std::uint64_t needed_bytes);

/// "ok refresh rate: 60 Hz" and so on, one line each.
std::string format_preflight(const std::vector<PreflightLine>& lines);

}  // namespace study
