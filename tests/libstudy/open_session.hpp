#pragma once
/// Helpers to access the one open session of a store.

#include <stdexcept>
#include <vector>

#include "libstudy/store/store.hpp"

namespace study::test {

inline OpenSession only_session(Store& store) { return store.open_runs().at(0).sessions.at(0); }

inline const OpenUnit& first_trial(const OpenSession& session) {
  for (const OpenUnit& unit : session.units) {
    if (unit.trial) return unit;
  }
  throw std::logic_error("no trial is open");
}

inline const OpenUnit& unit_of(const OpenSession& session, int position) {
  for (const OpenUnit& unit : session.units) {
    if (unit.plan.position == position) return unit;
  }
  throw std::logic_error("the unit is done");
}

inline void answer(Store& store, const OpenSession& session, const OpenUnit& unit, int attempt,
                   const std::vector<KeptAnswer>& answers, bool last) {
  store.answer(session.id, unit, attempt, answers, last, 900);
}

}  // namespace study::test
