#pragma once
/// The reference answers in tests/stats/oracle, or in $VIP_ORACLE_DIR when that is set.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "stats/base/json.hpp"

namespace oracle {

inline std::filesystem::path folder() {
  const char* other = std::getenv("VIP_ORACLE_DIR");
  return other ? std::filesystem::path(other) : std::filesystem::path(VIP_TEST_DIR) / "stats" / "oracle";
}

inline base::Json cases(const std::string& family) {
  const auto path = folder() / (family + ".json");
  std::ifstream in(path);
  if (!in)
    throw std::runtime_error("cannot read " + path.string() + "; mend: restore it, or unset VIP_ORACLE_DIR");
  return base::Json::parse(in).at("cases");
}

/// A number, "Inf" or "-Inf"; null is a missing value and becomes NaN.
inline double number(const base::Json& item) {
  if (item.is_null()) return std::numeric_limits<double>::quiet_NaN();
  if (item == "Inf") return std::numeric_limits<double>::infinity();
  if (item == "-Inf") return -std::numeric_limits<double>::infinity();
  return item.get<double>();
}

/// Numbers, with NaN for null.
inline std::vector<double> numbers(const base::Json& list) {
  std::vector<double> out;
  for (const auto& item : list) out.push_back(number(item));
  return out;
}

/// True if the field exists and is not null, so that it must be compared.
inline bool asks(const base::Json& expect, const std::string& field) {
  return expect.contains(field) && !expect.at(field).is_null();
}

/// Bound for a field: relative to the expected value, or to `scale` where that value is zero.
inline double bound(double expected, double rtol, double scale) {
  return rtol * (expected == 0 ? scale : std::abs(expected));
}

/// Compares `got` with one expected number, within rtol relative to it. If the number is zero, or zero but
/// for rounding (below 1e-12 of `scale`, the size of the operands that were subtracted), within rtol of
/// `scale`.
inline void expect_number(const std::string& what, double got, const base::Json& expected, double rtol,
                          double scale = 1) {
  if (expected.is_null()) return;
  const double want = number(expected);
  if (std::isinf(want)) {
    EXPECT_EQ(got, want) << what;
    return;
  }
  const double allowed = bound(std::abs(want) < 1e-12 * scale ? 0 : want, rtol, scale);
  EXPECT_LE(std::abs(got - want), allowed) << what << ": " << got << " instead of " << want;
}

/// expect_number for a field of a case. Does nothing if the case has no such field. Fails if the case has the
/// field and there is no value. rtol is the case's own unless given.
inline void expect_field(const base::Json& c, const std::string& field, std::optional<double> got,
                         double scale = 1, std::optional<double> rtol = {}) {
  if (!asks(c.at("expect"), field)) return;
  const std::string what = c.at("id").get<std::string>() + ": " + field;
  if (!got) {
    ADD_FAILURE() << what << ": no value";
    return;
  }
  expect_number(what, *got, c.at("expect").at(field), rtol.value_or(c.at("rtol").get<double>()), scale);
}

/// A case without an answer must be refused with a reason.
template <class R>
void expect_refused(const base::Json& c, const R& result) {
  EXPECT_FALSE(result) << c.at("id") << ": a number where there is none";
  if (!result) {
    EXPECT_FALSE(result.reason().empty()) << c.at("id");
  }
}

inline bool is_undefined(const base::Json& c) { return c.at("expect").at("status") == "undefined"; }

}  // namespace oracle
