/// Slots that a central database deals, without a database: a stand-in keeps the server's books in memory.
#include "libstudy/store/reserved_slots.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "tests/libstudy/slot_histories.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using sqlite::Open;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using ::testing::ThrowsMessage;

/// The server's books, by the rules of docs/central.md.
class BooksInMemory : public test::SlotCentre {
 public:
  std::unique_ptr<SlotServer> connect(int) override { return std::make_unique<Link>(*this); }

  void push(int station, const fs::path& path) override {
    sqlite::Connection database(path, Open::Read);
    auto& own = sessions_[station];
    own.clear();
    sqlite::Statement row(database,
                          "SELECT slot, coalesce(reservation, ''), state IN ('open', 'done', 'stopped') "
                          "FROM session");
    while (row.step()) own.push_back({static_cast<int>(row.integer(0)), row.text(1), row.integer(2) != 0});
  }

  int open_reservations() override {
    int open = 0;
    for (const auto& [name, one] : reservations_) open += is_open(name, one) ? 1 : 0;
    return open;
  }

  int requests = 0;

 private:
  struct Session {
    int slot;
    std::string reservation;
    bool counts;
  };
  struct Reservation {
    int slot = 0;
    bool returned = false;
  };

  bool is_open(const std::string& name, const Reservation& one) const {
    if (one.returned) return false;
    for (const auto& [station, sessions] : sessions_)
      for (const Session& session : sessions)
        if (session.counts && session.reservation == name) return false;
    return true;
  }

  int least_used(int slots) const {
    std::vector<int> uses(static_cast<std::size_t>(slots));
    for (const auto& [station, sessions] : sessions_)
      for (const Session& session : sessions)
        uses[static_cast<std::size_t>(session.slot)] += session.counts ? 1 : 0;
    for (const auto& [name, one] : reservations_)
      uses[static_cast<std::size_t>(one.slot)] += is_open(name, one) ? 1 : 0;
    return static_cast<int>(std::min_element(uses.begin(), uses.end()) - uses.begin());
  }

  struct Link : SlotServer {
    explicit Link(BooksInMemory& books) : books_(&books) {}
    std::vector<int> reserve(const std::string& token, const SlotRequest& request) override {
      ++books_->requests;
      std::vector<int> slots;
      for (int place = 0; place < request.wanted; ++place) {
        const std::string name = token + "." + std::to_string(place);
        if (!books_->reservations_.contains(name))
          books_->reservations_[name] = {books_->least_used(request.slots), false};
        slots.push_back(books_->reservations_[name].slot);
      }
      return slots;
    }
    void give_back(const std::string& token, const std::vector<int>& places) override {
      for (const int place : places)
        books_->reservations_.at(token + "." + std::to_string(place)).returned = true;
    }
    BooksInMemory* books_;
  };

  std::map<int, std::vector<Session>> sessions_;
  std::map<std::string, Reservation> reservations_;
};

SlotRequest request_of(const Protocol& protocol, int wanted) {
  return {"lab", protocol.sha256, slot_count(protocol), wanted, false};
}

void plan_at(Store& store, const Protocol& protocol, const std::string& code, const DealtSlot& slot) {
  SessionPlan session = test::session_plan(protocol, code, 7, slot.slot);
  session.reservation = slot.reservation;
  store.add_run({protocol, "{}", {session}});
}

std::vector<int> slots_of(const std::vector<DealtSlot>& dealt) {
  std::vector<int> out;
  for (const DealtSlot& one : dealt) out.push_back(one.slot);
  return out;
}

class ReservedSlots : public ::testing::Test {
 protected:
  const Protocol protocol_ = parse_protocol(test::protocol_text("own_design"), "own");
  test::TemporaryFolder folder_;
  const fs::path path_ = folder_ / "s.db";
  BooksInMemory books_;
  std::string offline_;

  SlotConnection online() {
    return [this] { return books_.connect(0); };
  }
  static std::unique_ptr<SlotServer> cut() { throw test::cut_off(); }
};

TEST_F(ReservedSlots, OnlineTheServerIsAskedAndOfflineTheBlockIsUsed) {
  Store store(path_, Open::Create);
  EXPECT_THAT(reserve_block(store, *books_.connect(0), request_of(protocol_, 2)), ElementsAre(0, 1));
  const auto first = deal_slots(store, online(), request_of(protocol_, 1), offline_);
  EXPECT_THAT(slots_of(first), ElementsAre(2));
  EXPECT_EQ(offline_, "");
  plan_at(store, protocol_, "P01", first.front());
  const auto later = deal_slots(store, cut, request_of(protocol_, 1), offline_);
  EXPECT_THAT(slots_of(later), ElementsAre(0));
  EXPECT_EQ(offline_, "the connection was cut");
  plan_at(store, protocol_, "P02", later.front());
  EXPECT_THAT([&] { deal_slots(store, cut, request_of(protocol_, 2), offline_); },
              ThrowsMessage<base::Error>(HasSubstr("1 are left for 2 sessions")));
  EXPECT_EQ(books_.requests, 2);
}

TEST_F(ReservedSlots, ARequestIsSentAgainWithItsToken) {
  Store store(path_, Open::Create);
  RandomStream chance(1);
  const auto after_the_commit = [&]() -> std::unique_ptr<SlotServer> {
    struct Cut : SlotServer {
      explicit Cut(std::unique_ptr<SlotServer> server) : server_(std::move(server)) {}
      std::vector<int> reserve(const std::string& token, const SlotRequest& request) override {
        server_->reserve(token, request);
        throw test::cut_off();
      }
      void give_back(const std::string&, const std::vector<int>&) override {}
      std::unique_ptr<SlotServer> server_;
    };
    return std::make_unique<Cut>(books_.connect(0));
  };
  EXPECT_THROW(deal_slots(store, after_the_commit, request_of(protocol_, 1), offline_), base::Error);
  EXPECT_THAT(store.reserved_slots(), SizeIs(1));
  EXPECT_EQ(store.reserved_slots().front().state, SlotState::Asked);
  EXPECT_THAT(slots_of(deal_slots(store, online(), request_of(protocol_, 2), offline_)), ElementsAre(0, 1));
  EXPECT_EQ(books_.open_reservations(), 2);
}

TEST_F(ReservedSlots, ADropoutFreesTheSlotHereAndAtTheNextSettlingThere) {
  Store store(path_, Open::Create);
  plan_at(store, protocol_, "P01", deal_slots(store, online(), request_of(protocol_, 1), offline_).front());
  EXPECT_EQ(store.reserved_slots().front().taken_by, "P01");
  const auto session = store.open_runs().front().sessions.front();
  store.end_session(session.id, {EarlyEnd::DroppedOut, ""}, 900);
  EXPECT_TRUE(store.reserved_slots().front().is_free());
  EXPECT_EQ(settle_slots(store, *books_.connect(0), "elsewhere").returned, 0);
  EXPECT_EQ(settle_slots(store, *books_.connect(0), "lab").returned, 1);
  EXPECT_EQ(settle_slots(store, *books_.connect(0), "lab").returned, 0);
  EXPECT_EQ(books_.open_reservations(), 0);
  EXPECT_EQ(store.reserved_slots().front().state, SlotState::Returned);
}

TEST_F(ReservedSlots, ABlockStaysAtASettlingUntilItIsReturned) {
  Store store(path_, Open::Create);
  reserve_block(store, *books_.connect(0), request_of(protocol_, 3));
  EXPECT_EQ(settle_slots(store, *books_.connect(0), "lab").returned, 0);
  EXPECT_EQ(settle_slots(store, *books_.connect(0), "lab", true).returned, 3);
  EXPECT_THROW(deal_slots(store, cut, request_of(protocol_, 1), offline_), base::Error);
}

TEST_F(ReservedSlots, AMergeKeepsThoseOfItsTargetAndSalvageKeepsAll) {
  const fs::path other = folder_ / "other.db";
  for (const fs::path& path : {path_, other}) {
    Store store(path, Open::Create);
    reserve_block(store, *books_.connect(0), request_of(protocol_, 2));
    plan_at(store, protocol_, path == other ? "P02" : "P01",
            deal_slots(store, online(), request_of(protocol_, 1), offline_).front());
  }
  salvage(path_, folder_ / "salvaged.db");
  EXPECT_THAT(Store(folder_ / "salvaged.db", Open::Write).reserved_slots(), SizeIs(3));
  const Merge done = merge({other}, path_);
  EXPECT_THAT(done.station_troubles, IsEmpty()) << "the central database parted the slots";
  const auto kept = Store(path_, Open::Write).reserved_slots();
  EXPECT_THAT(kept, SizeIs(3));
  EXPECT_EQ(std::count_if(kept.begin(), kept.end(), [](const auto& one) { return one.is_free(); }), 2);
  merge({path_, other}, folder_ / "all.db");
  EXPECT_THAT(Store(folder_ / "all.db", Open::Write).reserved_slots(), IsEmpty());
}

TEST_F(ReservedSlots, RandomHistoriesLeaveNoGapAndNoDouble) {
  int people = 0;
  for (std::uint64_t seed = 1; seed <= 1; ++seed) {
    SCOPED_TRACE(seed);
    BooksInMemory books;
    test::check_slot_history(books, seed, 25, people);
  }
  EXPECT_GT(people, 5);
}

TEST(ReservedSlotsSlow, RandomHistoriesLeaveNoGapAndNoDouble) {
  int people = 0;
  for (std::uint64_t seed = 100; seed < 120; ++seed) {
    SCOPED_TRACE(seed);
    BooksInMemory books;
    test::check_slot_history(books, seed, 80, people);
  }
  RecordProperty("people", people);
}

}  // namespace
}  // namespace study
