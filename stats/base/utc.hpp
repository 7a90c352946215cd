#pragma once
/// Times in UTC as texts, such as "2026-01-31T12:00:00Z", and a fixed clock for tests.

#include <cstdint>
#include <optional>
#include <string>

namespace base {

/// A clock that shows an earlier time is wrong, because ViP-Lab did not exist then.
inline constexpr const char* before_vip_lab_utc = "2024-01-01T00:00:00Z";

/// The day on which this program was built, at 00:00:00.
std::string built_utc();

/// The type, compiler and switches of this build, as --version prints them.
std::string build_options();

/// Seconds since 1970. Empty if the text is not a time in the format of utc_now().
std::optional<std::int64_t> seconds_of_utc(const std::string& utc);
std::string utc_of_seconds(std::int64_t seconds);

/// For tests: while an object of this class exists, utc_now() returns the fixed time `utc` in all threads.
class FixedUtc {
 public:
  explicit FixedUtc(const std::string& utc);
  ~FixedUtc();
  FixedUtc(const FixedUtc&) = delete;
  FixedUtc& operator=(const FixedUtc&) = delete;
};

}  // namespace base
