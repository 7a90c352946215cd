#pragma once
/// Check that tests compare every field of the reference answers.

#include <gtest/gtest.h>

#include <algorithm>
#include <initializer_list>
#include <string_view>

#include "stats/base/json.hpp"

namespace oracle {

/// Fails for each field of a case's answer that is neither in `compared`, nor status or reason, nor null.
inline void expect_known_fields(const base::Json& c, std::initializer_list<std::string_view> compared) {
  for (const auto& [field, want] : c.at("expect").items()) {
    const bool about = field == "status" || field == "reason" || want.is_null();
    EXPECT_TRUE(about || std::find(compared.begin(), compared.end(), field) != compared.end())
        << c.at("id") << ": nobody compares " << field;
  }
}

}  // namespace oracle
