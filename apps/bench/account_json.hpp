#pragma once
/// A frame's account in figures, under the names of the database's columns.

#include <optional>

#include "libsim/particles/divergence.hpp"
#include "libstudy/display/stimulus.hpp"
#include "stats/base/json.hpp"

namespace apps {

/// null: not measured.
inline base::Json or_null(const std::optional<double>& value) {
  return value ? base::Json(*value) : base::Json();
}

/// frame: since the gate opened.
base::Json account_json(std::int64_t frame, const study::FrameFacts& facts);

/// null: a sound run.
base::Json divergence_json(const std::optional<sim::Divergence>& divergence);

}  // namespace apps
