#pragma once
/// A frame's account as JSON, with the names of the database's columns.

#include <optional>

#include "libsim/particles/divergence.hpp"
#include "libstudy/display/stimulus.hpp"
#include "stats/base/json.hpp"

namespace apps {

/// frame: counted from the opening of the gate. Null if not measured.
base::Json account_json(std::int64_t frame, const study::FrameFacts& facts);

/// Null if the run did not diverge.
base::Json divergence_json(const std::optional<sim::Divergence>& divergence);

}  // namespace apps
