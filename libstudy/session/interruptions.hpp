#pragma once
/// What becomes of the trial that was under way when a session stopped, by the protocol's policy.

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// Applies Block::on_interruption to the trial that was begun and not done, if there is one, before the
/// session goes on. True when the store was changed: what is open must then be read again.
bool settle_interruption(Store& store, const Protocol& protocol, const OpenSession& session);

}  // namespace study
