/// Push and pull in a build without libpq: they end with an error.
#include "libstudy/store/central/central_admin.hpp"
#include "libstudy/store/push/push.hpp"

namespace study {

Push push(const StudyFile&, const std::string& service,
          const std::function<void(std::int64_t done, std::int64_t all)>&) {
  central::upgrade(service);  // throws the error of such a build
  return {};
}

std::vector<std::string> withdrawn_at_centre(const StudyFile&, const std::string& service) {
  central::upgrade(service);
  return {};
}

}  // namespace study
