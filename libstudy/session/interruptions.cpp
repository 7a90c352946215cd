#include "libstudy/session/interruptions.hpp"

#include <algorithm>

namespace study {

bool settle_interruption(Store& store, const Protocol& protocol, const OpenSession& session) {
  const auto cut = std::find_if(session.units.begin(), session.units.end(),
                                [](const OpenUnit& unit) { return unit.begun; });
  if (cut == session.units.end()) return false;
  switch (protocol.blocks.at(static_cast<std::size_t>(cut->plan.block)).on_interruption) {
    case Interruption::Resume:
      return false;
    case Interruption::RestartBlock:
      store.restart_block(session.id, cut->plan.block, "block restarted after an interruption");
      return true;
    case Interruption::Invalidate:
      store.leave_out_trial(session.id, *cut, "interrupted");
      return true;
  }
  return false;
}

}  // namespace study
