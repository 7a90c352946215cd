/// The central database without libpq: its functions end with an error.
#include "libstudy/store/central/postgres.hpp"

namespace study::pg {

// Each function of the central database begins with a connection.
Connection::Connection(const std::string& service) {
  check_service_name(service);
  throw base::Error("service " + service, "this build has no PostgreSQL (it found no libpq)",
                    "install libpq-dev and build again");
}

}  // namespace study::pg
