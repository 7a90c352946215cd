/// Slots from a central database, against a real server.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/remote/slot_server.hpp"
#include "tests/libstudy/central_world.hpp"
#include "tests/libstudy/slot_histories.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::string token_a(32, 'a'), token_b(32, 'b'), protocol_hash(64, '0');

SlotRequest six_slots(int wanted) { return {"", protocol_hash, 6, wanted, false}; }

TEST(CentralSlots, AreDealtFromBelowAndTheSameForOneToken) {
  test::CentralWorld world("slots_dealt");
  const std::string south_role = world.station("south");
  const auto north = connect_slots(world.station("north")), south = connect_slots(south_role);
  EXPECT_THAT(north->reserve(token_a, six_slots(4)), ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(south->reserve(token_b, six_slots(9)), ElementsAre(4, 5, 0, 1, 2, 3, 4, 5, 0));
  EXPECT_THAT(north->reserve(token_a, six_slots(4)), ElementsAre(0, 1, 2, 3));
  north->give_back(token_a, {1, 3});
  north->give_back(token_a, {1, 3});
  EXPECT_THAT(north->reserve(std::string(32, 'c'), six_slots(3)), ElementsAre(1, 3, 1));
  EXPECT_EQ(world.sql("SELECT vip.release_station('" + south_role + "')"), "9");
  EXPECT_EQ(world.sql("SELECT count(*) FROM vip.open_reservation"), "5");
}

TEST(CentralSlots, AStationReachesNeitherAnothersSlotsNorTheBooks) {
  test::CentralWorld world("slots_rights");
  const std::string north = world.station("north"), reader = world.reader("reader");
  connect_slots(world.station("south"))->reserve(token_a, six_slots(2));
  const auto own = connect_slots(north);
  EXPECT_THAT([&] { own->reserve(token_a, six_slots(2)); },
              ThrowsMessage<base::Error>(HasSubstr("of another station")));
  own->give_back(token_a, {0, 1});
  EXPECT_EQ(world.sql("SELECT count(*) FROM vip.open_reservation"), "2");
  SlotRequest other = six_slots(1);
  other.slots = 12;
  EXPECT_THAT([&] { own->reserve(token_b, other); },
              ThrowsMessage<base::Error>(HasSubstr("6 slots here, and 12 at the station")));
  EXPECT_THROW(own->reserve("' OR 1 = 1", six_slots(1)), base::Error);
  EXPECT_THROW(connect_slots(reader)->reserve(token_b, six_slots(1)), base::Error);
  pg::Connection direct(north);
  for (const char* sql :
       {"SELECT * FROM vip.reservation", "SELECT * FROM vip.open_reservation",
        "SELECT * FROM vip.slot_session", "INSERT INTO vip.slot_count VALUES (repeat('1', 64), 1)",
        "DELETE FROM vip.reservation", "SELECT vip.release_station('slots_rights_south')",
        "BEGIN ISOLATION LEVEL REPEATABLE READ; SELECT vip.reserve_slots(repeat('d', 32), repeat('0', 64), "
        "6, 1)"})
    EXPECT_THROW(direct.script(sql), base::Error) << sql;
}

TEST(CentralSlots, AServerThatIsGoneIsToldFromARefusal) {
  test::CentralWorld world("slots_gone");
  const std::string north = world.station("north");
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
  explicit CentralBooks(const std::string& name) : world_(name) {
    for (int i = 0; i < test::SlotHistory::stations; ++i)
      services_.push_back(world_.station("s" + std::to_string(i)));
  }
  std::unique_ptr<SlotServer> connect(int station) override {
    return connect_slots(services_.at(static_cast<std::size_t>(station)));
  }
  void push(int station, const fs::path& database) override {
    test::send_all(services_.at(static_cast<std::size_t>(station)), database);
  }
  int open_reservations() override {
    return std::stoi(world_.sql("SELECT count(*) FROM vip.open_reservation"));
  }

 private:
  test::CentralWorld world_;
  std::vector<std::string> services_;
};

TEST(CentralSlots, RandomHistoriesLeaveNoGapAndNoDouble) {
  int people = 0;
  CentralBooks books("slots_random");
  test::check_slot_history(books, 3, 40, people);
  EXPECT_GT(people, 10);
}

TEST(CentralSlotsSlow, RandomHistoriesLeaveNoGapAndNoDouble) {
  int people = 0;
  for (std::uint64_t seed = 200; seed < 240; ++seed) {
    SCOPED_TRACE(seed);
    CentralBooks books("slots_random_" + std::to_string(seed));
    test::check_slot_history(books, seed, 120, people);
  }
  RecordProperty("people", people);
}

}  // namespace
}  // namespace study
