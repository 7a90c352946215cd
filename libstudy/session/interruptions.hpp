#pragma once
/// Applies the protocol's policy to the trial that was under way when a session stopped.

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// Applies Block::on_interruption to the trial that was begun and not done, if any, before the session goes
/// on. True if the store was changed: read the open units again.
bool settle_interruption(Store& store, const Protocol& protocol, const OpenSession& session);

}  // namespace study
