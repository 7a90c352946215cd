/// Any bytes as the log of a light sensor: refused with base::Error, or read. A log that was read has
/// ascending times and a level for each, and its changes of light alternate.

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include "libstudy/light/light_edges.hpp"
#include "libstudy/light/sensor_log.hpp"
#include "tests/fuzz/attempt.hpp"

namespace {

void check(const study::SensorLog& log) {
  if (log.level.size() != log.time_s.size()) std::abort();
  if (!log.trigger.empty() && log.trigger.size() != log.time_s.size()) std::abort();
  for (std::size_t i = 1; i < log.time_s.size(); ++i)
    if (!(log.time_s[i] > log.time_s[i - 1])) std::abort();
  fuzz::attempt([&] {
    const auto levels = study::find_levels(log.level, "fuzz", "its level");
    const auto edges = study::find_edges(log, log.level, levels, 0);
    for (std::size_t i = 1; i < edges.size(); ++i)
      if (edges[i].rise == edges[i - 1].rise || edges[i].time_s < edges[i - 1].time_s) std::abort();
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("fuzz_sensor_log." + std::to_string(::getpid()));
  std::ofstream(file, std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  for (const char* unit : {"", "us"}) fuzz::attempt([&] { check(study::read_sensor_log(file, {unit, {}})); });
  std::filesystem::remove(file);
  return 0;
}
