/// vip-study slots: slots of the assignment that a central database reserves for this station.
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/find_protocol.hpp"
#include "libstudy/store/remote/slot_server.hpp"
#include "stats/base/error.hpp"
#include "stats/base/streams.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

struct SlotsCommand {
  std::string database, protocol, service;
  int count = 0;
};

void reserve_slots(const SlotsCommand& command) {
  const study::Protocol protocol = study::read_protocol(study::find_protocol(command.protocol));
  study::Store store(command.database, study::sqlite::Open::Create);
  const auto server = study::connect_slots(command.service);
  const auto slots = study::reserve_block(
      store, *server, {command.service, protocol.sha256, study::slot_count(protocol), command.count, true});
  std::string listed;
  for (const int slot : slots) listed += (listed.empty() ? "" : ", ") + std::to_string(slot);
  std::printf("%s: %zu slots of protocol %s are reserved: %s\n", command.database.c_str(), slots.size(),
              base::shortened(protocol.name).c_str(), listed.c_str());
  store.require_journal();
}

void return_slots(const SlotsCommand& command) {
  study::Store store(command.database, study::sqlite::Open::Write);
  const auto server = study::connect_slots(command.service);
  const study::SettledSlots done = study::settle_slots(store, *server, command.service, true);
  std::printf("%s: %d slots returned\n", command.database.c_str(), done.returned);
  store.require_journal();
}

const char* words_of(const study::ReservedSlot& one) {
  if (one.state == study::SlotState::Asked) return "asked for, no answer yet";
  if (one.state == study::SlotState::Returning) return "to be returned";
  if (one.state == study::SlotState::Returned) return "returned";
  return one.block ? "free, reserved in advance" : "free";
}

void list_slots(const SlotsCommand& command) {
  const auto slots = study::read_reserved_slots(command.database);
  std::map<std::pair<std::string, std::string>, int> returned;
  for (const study::ReservedSlot& one : slots) {
    if (one.state == study::SlotState::Returned) {
      ++returned[{one.service, one.protocol_sha256}];
      continue;
    }
    std::printf("%s  protocol %s  slot %4s of %d  %s\n", base::shortened(one.service).c_str(),
                one.protocol_sha256.substr(0, 12).c_str(),
                one.slot < 0 ? "-" : std::to_string(one.slot).c_str(), one.slots,
                one.taken_by.empty() ? words_of(one) : ("has " + base::shortened(one.taken_by)).c_str());
  }
  for (const auto& [of, count] : returned)
    std::printf("%s  protocol %s  %d returned\n", base::shortened(of.first).c_str(),
                of.second.substr(0, 12).c_str(), count);
  if (slots.empty()) std::printf("%s: no slots were reserved\n", command.database.c_str());
}

}  // namespace

void return_slots_after_push(const std::string& database, const std::string& service) {
  if (!study::needs_settling(study::read_reserved_slots(database), service)) return;
  try {
    study::Store store(database, study::sqlite::Open::Write);
    const auto done = study::settle_slots(store, *study::connect_slots(service), service);
    if (done.returned > 0) std::printf("%d slots returned that sessions gave up\n", done.returned);
    store.require_journal();
  } catch (const base::Error& error) {
    std::fprintf(stderr, "slots are returned at a later push: %s\n",
                 base::for_terminal(error.what()).c_str());
  }
}

void add_slots_command(CLI::App& app) {
  auto command = std::make_shared<SlotsCommand>();
  CLI::App& sub = *app.add_subcommand(
      "slots", "Slots of the assignment that a central database reserves for this station");
  sub.require_subcommand(1);
  CLI::App& list = *sub.add_subcommand("list", "Say which slots are reserved, and who has them");
  add_database(list, command->database);
  list.callback([command] { list_slots(*command); });
  CLI::App& reserve = *sub.add_subcommand("reserve", "Reserve slots for times without a network");
  reserve.add_option("count", command->count, "Number of slots")
      ->required()
      ->check(CLI::Range(1, study::most_wanted_slots));
  reserve
      .add_option("--protocol", command->protocol,
                  "Protocol file, or the name of one that comes with the program, such as task1")
      ->required();
  add_database(reserve, command->database)->check(output_file());
  add_service(reserve, "--from", command->service, "Service of the central database");
  reserve.callback([command] { reserve_slots(*command); });
  CLI::App& back = *sub.add_subcommand("return", "Return the reserved slots that no session has");
  add_database(back, command->database);
  add_service(back, "--from", command->service, "Service of the central database");
  back.callback([command] { return_slots(*command); });
}

}  // namespace apps
