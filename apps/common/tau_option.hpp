#pragma once
/// --tau as users write it.

#include <optional>
#include <string>

namespace apps {

/// "live" = nothing: tau comes from the measured frame rate. "fixed:X" = X frames/s. Others are a base::Error
/// that also names `more`.
std::optional<double> parse_tau(const std::string& word, const std::string& more = "");

}  // namespace apps
