#pragma once
/// Applies the protocol's policy for interrupted trials (Block::on_interruption) when a session is resumed.

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// Applies Block::on_interruption to the trial that was begun but not done, if there is one. Call it before
/// the session continues. True if the store was changed: then read the open units again.
bool settle_interruption(Store& store, const Protocol& protocol, const OpenSession& session);

}  // namespace study
