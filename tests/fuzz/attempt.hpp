#pragma once
/// What the entry points share.

#include "stats/base/error.hpp"

namespace fuzz {

/// Runs `action`; its base::Error is an end as good as any, all else a finding.
template <class Action>
void attempt(Action action) {
  try {
    action();
  } catch (const base::Error&) {
  }
}

}  // namespace fuzz
