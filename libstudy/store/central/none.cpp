/// The central database in a build without libpq: each function ends with an error.
#include "libstudy/store/central/central_admin.hpp"
#include "stats/base/error.hpp"

namespace study::central {

namespace {

[[noreturn]] void refuse_without_libpq(const std::string& service) {
  throw base::Error("service " + service, "this build cannot speak to PostgreSQL (it found no libpq)",
                    "install libpq-dev and build again");
}

}  // namespace

void init(const std::string& service) { refuse_without_libpq(service); }
Upgrade upgrade(const std::string& service) { refuse_without_libpq(service); }
void admit(const std::string& service, const std::string&, Admission) { refuse_without_libpq(service); }

}  // namespace study::central
