#pragma once
/// A frame's account in figures, under the names of the database's columns.

#include <nlohmann/json.hpp>
#include <optional>

#include "libsim/particles/divergence.hpp"
#include "libstudy/display/stimulus.hpp"

namespace apps {

/// null: not measured.
inline nlohmann::json or_null(const std::optional<double>& value) {
  return value ? nlohmann::json(*value) : nlohmann::json();
}

/// frame: since the gate opened.
nlohmann::json account_json(std::int64_t frame, const study::FrameFacts& facts);

/// null: a sound run.
nlohmann::json divergence_json(const std::optional<sim::Divergence>& divergence);

}  // namespace apps
