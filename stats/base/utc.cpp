#include "stats/base/utc.hpp"

#include <atomic>
#include <ctime>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace base {

namespace {

constexpr const char* format = "%Y-%m-%dT%H:%M:%SZ";
constexpr std::int64_t not_fixed = INT64_MIN;
std::atomic<std::int64_t> fixed_s = not_fixed;

}  // namespace

std::optional<std::int64_t> seconds_of_utc(const std::string& utc) {
  std::tm parts{};
  const char* const end = ::strptime(utc.c_str(), format, &parts);
  if (!end || *end != '\0') return {};
  return ::timegm(&parts);
}

std::string utc_of_seconds(std::int64_t seconds) {
  const std::time_t time = seconds;
  std::tm utc{};
  gmtime_r(&time, &utc);
  char text[32];
  std::strftime(text, sizeof text, format, &utc);
  return text;
}

std::string built_utc() { return VIP_BUILT_ON "T00:00:00Z"; }

std::string build_options() { return VIP_BUILD_OPTIONS; }

std::string utc_now() {
  const std::int64_t fixed = fixed_s;
  return utc_of_seconds(fixed == not_fixed ? std::time(nullptr) : fixed);
}

FixedUtc::FixedUtc(const std::string& utc) {
  const auto seconds = seconds_of_utc(utc);
  if (!seconds) throw Error(utc, "is no time in UTC", "write it as 2026-01-31T12:00:00Z");
  fixed_s = *seconds;
}

FixedUtc::~FixedUtc() { fixed_s = not_fixed; }

}  // namespace base
