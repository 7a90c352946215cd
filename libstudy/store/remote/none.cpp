/// Slots and studies of a central database without libpq: they end with an error.
#include "libstudy/store/central/postgres.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/remote/central_study.hpp"
#include "libstudy/store/remote/slot_server.hpp"

namespace study {

std::unique_ptr<SlotServer> connect_slots(const std::string& service) {
  pg::Connection central(service);
  throw std::logic_error("a connection was made without libpq");
}

std::unique_ptr<sqlite::Connection> read_central_study(const std::string& service) {
  pg::Connection central(service);
  throw std::logic_error("a connection was made without libpq");
}

void read_central_studies(std::function<void(const std::string& line)>) {
  read_central_with(read_central_study);
}

}  // namespace study
