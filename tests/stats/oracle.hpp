#pragma once
/// The reference answers in tests/stats/oracle, or in $VIP_ORACLE_DIR when that is set.

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace oracle {

inline std::filesystem::path folder() {
  const char* other = std::getenv("VIP_ORACLE_DIR");
  return other ? std::filesystem::path(other) : std::filesystem::path(VIP_TEST_DIR) / "stats" / "oracle";
}

inline nlohmann::json cases(const std::string& family) {
  const auto path = folder() / (family + ".json");
  std::ifstream in(path);
  if (!in) throw std::runtime_error("cannot read " + path.string());
  return nlohmann::json::parse(in).at("cases");
}

/// null = missing = NaN.
inline std::vector<double> numbers(const nlohmann::json& list) {
  std::vector<double> out;
  for (const auto& item : list) {
    out.push_back(item.is_null() ? std::numeric_limits<double>::quiet_NaN() : item.get<double>());
  }
  return out;
}

/// Bound for a field: relative, and absolute in units of `scale` where the answer is zero.
inline double bound(double expected, double rtol, double scale) {
  return rtol * (expected == 0 ? scale : std::abs(expected));
}

}  // namespace oracle
