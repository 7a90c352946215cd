#pragma once
/// Applies the protocol's policy for interrupted trials (Block::on_interruption) when a session is resumed.

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/store.hpp"

namespace study {

/// Applies Block::on_interruption to the trial that was begun but not done, if there is one: the trial stays
/// open and is shown again (Resume), all begun trials of its block are shown again (RestartBlock), or the
/// trial is excluded (Invalidate). Call it before the session continues. True if the store was changed: then
/// read the open units again.
bool settle_interruption(Store& store, const Protocol& protocol, const OpenSession& session);

}  // namespace study
