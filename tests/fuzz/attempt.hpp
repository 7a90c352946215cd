#pragma once
/// Helper of the entry points.

#include "stats/base/error.hpp"

namespace fuzz {

/// Runs `action`; a base::Error is a valid result, any other failure is a finding.
template <class Action>
void attempt(Action action) {
  try {
    action();
  } catch (const base::Error&) {
  }
}

}  // namespace fuzz
