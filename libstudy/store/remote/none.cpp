/// Slots and studies of a central database without libpq: they end with an error.
#include "libstudy/store/central/central_admin.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/remote/central_study.hpp"
#include "libstudy/store/remote/slot_server.hpp"

namespace study {

std::unique_ptr<SlotServer> connect_slots(const std::string& service) {
  central::upgrade(service);  // throws the error of such a build
  return {};
}

std::unique_ptr<sqlite::Connection> read_central_study(const std::string& service) {
  central::upgrade(service);  // throws the error of such a build
  return {};
}

void read_central_studies(std::function<void(const std::string& line)>) {
  read_central_with(read_central_study);
}

}  // namespace study
