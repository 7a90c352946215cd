/// Slots from a central database, against a real server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/remote/slot_server.hpp"
#include "tests/libstudy/central_fixture.hpp"
#include "tests/libstudy/slot_histories.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::string token_a(32, 'a'), token_b(32, 'b'), token_c(32, 'c');

/// Number of open reservations of a protocol.
std::string open_of(test::Lab& lab, const std::string& protocol) {
  return lab.ask("SELECT count(*) FROM vip.open_reservation WHERE protocol_sha256 = '" + protocol + "'")
      .front();
}

SlotRequest six_slots(int wanted, char protocol = '0') {
  return {"", std::string(64, protocol), 6, wanted, false};
}

TEST(CentralSlots, AreDealtFromBelowAndTheSameForOneToken) {
  const std::string south_role = test::lab().admit("slots_south");
  const auto north = connect_slots(test::lab().admit("slots_north")), south = connect_slots(south_role);
  EXPECT_THAT(north->reserve(token_a, six_slots(4)), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(south->reserve(token_b, six_slots(9)), ElementsAre(4, 5, 0, 1, 2, 3, 4, 5, 0));
  EXPECT_THAT(north->reserve(token_a, six_slots(4)), ElementsAre(0, 1, 2, 3));
  north->give_back(token_a, {1, 3});
  north->give_back(token_a, {1, 3});
  EXPECT_THAT(north->reserve(token_c, six_slots(3)), ElementsAre(1, 3, 1));
  EXPECT_EQ(test::lab().ask("SELECT vip.release_station('" + south_role + "')").front(), "9");
  EXPECT_EQ(open_of(test::lab(), std::string(64, '0')), "5");
}

TEST(CentralSlots, AStationReachesNeitherAnothersSlotsNorTheBooks) {
  const std::string west = test::lab().admit("slots_west"), token(32, 'd');
  connect_slots(test::lab().admit("slots_east"))->reserve(token, six_slots(2, '1'));
  const auto own = connect_slots(west);
  EXPECT_THAT([&] { own->reserve(token, six_slots(2, '1')); },
              ThrowsMessage<base::Error>(HasSubstr("of another station")));
  own->give_back(token, {0, 1});
  EXPECT_EQ(open_of(test::lab(), std::string(64, '1')), "2");
  SlotRequest other = six_slots(1, '1');
  other.slots = 12;
  EXPECT_THAT([&] { own->reserve(std::string(32, 'e'), other); },
              ThrowsMessage<base::Error>(HasSubstr("6 slots here, and 12 at the station")));
  EXPECT_THROW(own->reserve("' OR 1 = 1", six_slots(1, '1')), base::Error);
  EXPECT_THROW(connect_slots(test::lab().admit("slot_reader", central::Admission::LabReader))
                   ->reserve(std::string(32, 'f'), six_slots(1, '1')),
               base::Error);
  pg::Connection direct(west);
  for (const char* sql :
       {"SELECT * FROM vip.reservation", "SELECT * FROM vip.open_reservation",
        "SELECT * FROM vip.slot_session", "INSERT INTO vip.slot_count VALUES (repeat('1', 64), 1)",
        "DELETE FROM vip.reservation", "SELECT vip.release_station('lab_slots_east')",
        "BEGIN ISOLATION LEVEL REPEATABLE READ; SELECT vip.reserve_slots(repeat('9', 32), repeat('1', 64), "
        "6, 1)"})
    EXPECT_THROW(direct.script(sql), base::Error) << sql;
}

TEST(CentralSlots, ASessionThatTwoStationsSentIsOneUse) {
  const test::TemporaryFolder folder;
  const Protocol pilot = test::pilot();
  const std::string first = test::lab().admit("slots_first");
  std::string reservation;
  {
    Store store(folder / "s.db", sqlite::Open::Create);
    std::string offline;
    const auto slots = deal_slots(
        store, [&] { return connect_slots(first); }, {first, pilot.sha256, slot_count(pilot), 1, false},
        offline);
    SessionPlan session = test::session_plan(pilot, "P01", 7, slots.front().slot);
    session.reservation = reservation = slots.front().reservation;
    EXPECT_EQ(open_of(test::lab(), pilot.sha256), "1");
    store.add_run({pilot, "{}", {session}});
  }
  for (const std::string& station : {first, test::lab().admit("slots_second")})
    study::push(folder / "s.db", station);
  EXPECT_EQ(open_of(test::lab(), pilot.sha256), "0");
  EXPECT_EQ(
      test::lab().ask("SELECT count(*) FROM vip.slot_session WHERE reservation = '" + reservation + "'"),
      std::vector<std::string>{"1"});
}

TEST(CentralSlotsSlow, AServerThatIsGoneIsToldFromARefusal) {
  test::Lab gone("slots_gone");
  const std::string north = gone.admit("north");
  const auto server = connect_slots(north);
  test::postgres_server().stop_immediately();
  EXPECT_THROW(server->reserve(token_a, six_slots(1)), ServerUnreachable);
  EXPECT_THROW(connect_slots(north), ServerUnreachable);
  test::postgres_server().start();
  EXPECT_THAT(connect_slots(north)->reserve(token_a, six_slots(1)), ElementsAre(0));
  EXPECT_THROW(connect_slots("host=x"), base::Error);
}

/// The books of a real central database.
class CentralBooks : public test::SlotCentre {
 public:
  explicit CentralBooks(test::Lab& lab) : lab_(lab) {
    for (int i = 0; i < test::SlotHistory::stations; ++i)
      services_.push_back(lab_.admit("slots" + std::to_string(i)));
  }
  std::unique_ptr<SlotServer> connect(int station) override {
    return connect_slots(services_.at(static_cast<std::size_t>(station)));
  }
  void push(int station, const fs::path& database) override {
    study::push(database, services_.at(static_cast<std::size_t>(station)));
  }
  int open_reservations() override { return std::stoi(open_of(lab_, test::SlotHistory::protocol().sha256)); }

 private:
  test::Lab& lab_;
  std::vector<std::string> services_;
};

TEST(CentralSlots, RandomHistoriesLeaveNoGapAndNoDouble) {
  int people = 0;
  CentralBooks books(test::lab());
  test::check_slot_history(books, 3, 12, people);
  EXPECT_GT(people, 2);
}

TEST(CentralSlotsSlow, RandomHistoriesLeaveNoGapAndNoDouble) {
  int people = 0;
  for (std::uint64_t seed = 200; seed < 240; ++seed) {
    SCOPED_TRACE(seed);
    test::Lab own("slots_" + std::to_string(seed));
    CentralBooks books(own);
    test::check_slot_history(books, seed, 60, people);
  }
  RecordProperty("people", people);
}

}  // namespace
}  // namespace study
