#pragma once
/// Checks of screen and computer before a participant begins. Each result is ok, warn or unknown.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace study {

/// Facts of the screen that shows the participant's window.
struct ScreenFacts {
  double reported_hz = 0;  ///< refresh rate that the system reports; 0: none
  double measured_hz = 0;  ///< refresh rate from buffer swaps; 0: swaps do not wait for the screen
  std::optional<bool> compositor;
  bool software_gl = false;
};

/// Facts of the computer.
struct StationFacts {
  std::vector<std::string> governors;  ///< distinct frequency governors of the CPUs; empty: not known
  std::optional<std::uint64_t> free_disk_bytes;      ///< on the database's disk
  std::optional<double> gpu_clock_mhz, gpu_max_mhz;  ///< from nvidia-smi
  std::optional<bool> on_battery;
};

enum class Readiness { Ok, Warn, Unknown };

struct PreflightLine {
  Readiness readiness = Readiness::Unknown;
  std::string what, finding;
};

/// Reads the facts from the system; a fact that the system does not report stays empty.
StationFacts read_station(const std::filesystem::path& database);

/// One line for each check. A line about graphics is included only if the CPU draws, and a line about power
/// only if station.on_battery is known. needed_bytes: estimate of the bytes that the session will write. A
/// pure function.
std::vector<PreflightLine> judge_preflight(const std::optional<ScreenFacts>& screen,
                                           const StationFacts& station, std::uint64_t needed_bytes);

/// Text with one row per line, such as "ok       compositor: none".
std::string format_preflight(const std::vector<PreflightLine>& lines);

}  // namespace study
