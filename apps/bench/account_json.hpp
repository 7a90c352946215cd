#pragma once
/// A frame's account in figures, under the names of the database's columns.

#include <optional>

#include "libsim/particles/divergence.hpp"
#include "libstudy/display/stimulus.hpp"
#include "stats/base/json.hpp"

namespace apps {

/// frame: since the gate opened. Null: not measured.
base::Json account_json(std::int64_t frame, const study::FrameFacts& facts);

/// null: a sound run.
base::Json divergence_json(const std::optional<sim::Divergence>& divergence);

}  // namespace apps
