#include "libstudy/store/remote/slot_server.hpp"

#include "libstudy/store/central/postgres.hpp"

namespace study {

namespace {

/// Does `work`; a lost connection becomes ServerUnreachable.
template <class Work>
auto reaching(const std::string& service, const Work& work) {
  try {
    return work();
  } catch (const pg::Failure& failure) {
    if (!failure.lost()) throw;
    const std::string place = "service " + service, words = failure.what();
    const std::string problem = words.substr(place.size() + 2, words.find('\n') - place.size() - 2);
    throw ServerUnreachable(place, problem, "connect this computer, and give the command again");
  }
}

std::string array_of(const std::vector<int>& places) {
  std::string text;
  for (const int place : places) text += (text.empty() ? "" : ",") + std::to_string(place);
  return "{" + text + "}";
}

class CentralSlots : public SlotServer {
 public:
  explicit CentralSlots(const std::string& service)
      : central_(reaching(service, [&] { return std::make_unique<pg::Connection>(service); })) {}

  std::vector<int> reserve(const std::string& token, const SlotRequest& request) override {
    return reaching(central_->service(), [&] {
      const auto rows = central_->run(
          "SELECT slot FROM vip.reserve_slots($1, $2, $3, $4) ORDER BY place",
          {token, request.protocol_sha256, std::to_string(request.slots), std::to_string(request.wanted)});
      std::vector<int> slots;
      for (int i = 0; i < rows.size(); ++i) slots.push_back(static_cast<int>(rows.integer(i, 0)));
      return slots;
    });
  }

  void give_back(const std::string& token, const std::vector<int>& places) override {
    reaching(central_->service(), [&] {
      return central_->run("SELECT vip.return_slots($1, $2)", {token, array_of(places)});
    });
  }

 private:
  std::unique_ptr<pg::Connection> central_;
};

}  // namespace

std::unique_ptr<SlotServer> connect_slots(const std::string& service) {
  return std::make_unique<CentralSlots>(service);
}

}  // namespace study
