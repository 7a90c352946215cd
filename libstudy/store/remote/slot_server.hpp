#pragma once
/// Slots of the assignment from a central database (PostgreSQL), by the functions of
/// libstudy/store/sql/central_slots.sql.

#include <memory>
#include <string>

#include "libstudy/store/reserved_slots.hpp"

namespace study {

/// A connection to the slots of the central database of `service`, a section of libpq's service file.
/// ServerUnreachable if no connection is made; base::Error if `service` is not a plain name, or if this build
/// has no libpq.
std::unique_ptr<SlotServer> connect_slots(const std::string& service);

}  // namespace study
