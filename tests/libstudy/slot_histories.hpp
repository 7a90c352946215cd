#pragma once
/// Random histories of stations that get slots of the assignment from one central database: online, offline,
/// cut before or after the server's commit, with dropouts, withdrawals, blocks and returns.

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "libstudy/base/random.hpp"
#include "libstudy/store/reserved_slots.hpp"
#include "libstudy/store/withdraw.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study::test {

/// The central database of a history.
class SlotCentre {
 public:
  virtual ~SlotCentre() = default;
  /// A connection of the station with this index.
  virtual std::unique_ptr<SlotServer> connect(int station) = 0;
  /// Sends the sessions and the withdrawals of a station.
  virtual void push(int station, const std::filesystem::path& database) = 0;
  /// Number of reservations that count as uses and have no session.
  virtual int open_reservations() = 0;
};

inline ServerUnreachable cut_off() { return {"centre", "the connection was cut", "try again"}; }

/// A connection that is cut before the request arrives, or after the server's commit.
class CutConnection : public SlotServer {
 public:
  CutConnection(std::unique_ptr<SlotServer> server, RandomStream& chance, double cuts)
      : server_(std::move(server)), chance_(&chance), cuts_(cuts) {}
  std::vector<int> reserve(const std::string& token, const SlotRequest& request) override {
    if (chance_->uniform() < cuts_) throw cut_off();
    auto slots = server_->reserve(token, request);
    if (chance_->uniform() < cuts_) throw cut_off();
    return slots;
  }
  void give_back(const std::string& token, const std::vector<int>& places) override {
    if (chance_->uniform() < cuts_) throw cut_off();
    server_->give_back(token, places);
    if (chance_->uniform() < cuts_) throw cut_off();
  }

 private:
  std::unique_ptr<SlotServer> server_;
  RandomStream* chance_;
  double cuts_;
};

/// Five stations and what happens to them.
class SlotHistory {
 public:
  static constexpr int stations = 5;
  static Protocol protocol() { return parse_protocol(protocol_text("own_design"), "own"); }

  SlotHistory(SlotCentre& centre, std::uint64_t seed)
      : centre_(centre), chance_(seed), protocol_(protocol()) {
    for (int i = 0; i < stations; ++i) Store(path(i), sqlite::Open::Create).add_run(run_of(i, {}));
  }

  void step() {
    const int station = static_cast<int>(chance_.below(stations));
    const std::uint64_t what = chance_.below(20);
    if (what < 9) return plan(station, chance_.uniform() < 0.6);
    if (what < 13) return end_a_session(station);
    if (what < 14) return withdraw_somebody(station);
    if (what < 16) return reserve(station, 1 + static_cast<int>(chance_.below(4)));
    if (what < 17) return give_back(station);
    push(station);
  }

  /// Brings every station online, pushes everything and returns all that is free.
  void reconcile() {
    cuts_ = 0;
    for (int i = 0; i < stations; ++i) {
      push(i);
      give_back(i);
    }
  }

  /// Plans people at random stations until every slot is used as often as the one that is used most.
  void fill() {
    const auto uses = this->uses();
    const int most = *std::max_element(uses.begin(), uses.end());
    int missing = 0;
    for (const int n : uses) missing += most - n;
    for (; missing > 0; --missing) {
      const auto before = this->uses();
      const auto least = std::min_element(before.begin(), before.end());
      plan(static_cast<int>(chance_.below(stations)), true);
      auto after = this->uses();
      --after[static_cast<std::size_t>(least - before.begin())];
      ASSERT_EQ(after, before) << "the lowest of the least used slots is next";
    }
  }

  /// Uses of each slot by the sessions that count, over all stations.
  std::vector<int> uses() {
    std::vector<int> uses(static_cast<std::size_t>(slot_count(protocol_)));
    for (int i = 0; i < stations; ++i) {
      sqlite::Connection database(path(i), sqlite::Open::Read);
      sqlite::Statement row(database, "SELECT slot FROM session WHERE state IN ('open', 'done', 'stopped')");
      while (row.step()) ++uses[static_cast<std::size_t>(row.integer(0))];
    }
    return uses;
  }

  /// A reservation that two sessions that count have; empty: none.
  std::string doubled() {
    std::set<std::string> known;
    for (int i = 0; i < stations; ++i) {
      sqlite::Connection database(path(i), sqlite::Open::Read);
      sqlite::Statement row(database,
                            "SELECT reservation FROM session WHERE state IN ('open', 'done', 'stopped') "
                            "AND reservation IS NOT NULL");
      while (row.step())
        if (!known.insert(row.text(0)).second) return row.text(0);
    }
    return {};
  }

  int people = 0, offline = 0, refused = 0, dropouts = 0, cuts = 0;

 private:
  std::filesystem::path path(int station) const {
    return folder_ / ("station" + std::to_string(station) + ".db");
  }

  SlotConnection connection(int station, bool online) {
    return [=, this]() -> std::unique_ptr<SlotServer> {
      if (!online) throw cut_off();
      return std::make_unique<CutConnection>(centre_.connect(station), chance_, cuts_);
    };
  }

  SlotRequest request(int wanted) const {
    return {"centre", protocol_.sha256, slot_count(protocol_), wanted, false};
  }

  RunPlan run_of(int station, const std::vector<DealtSlot>& slots) {
    RunPlan run{protocol_, "{}", {}};
    for (const DealtSlot& one : slots) {
      SessionPlan session = session_plan(
          protocol_, "S" + std::to_string(station) + "P" + std::to_string(++people), 7, one.slot);
      session.reservation = one.reservation;
      run.sessions.push_back(std::move(session));
    }
    return run;
  }

  void plan(int station, bool online) {
    Store store(path(station), sqlite::Open::Write);
    const int wanted = chance_.uniform() < 0.8 || cuts_ == 0 ? 1 : 2;
    try {
      std::string why;
      const auto slots = deal_slots(store, connection(station, online), request(wanted), why);
      offline += why.empty() ? 0 : 1;
      if (cuts_ > 0 && chance_.uniform() < 0.05) return;  // the computer fails before the plan is stored
      store.add_run(run_of(station, slots));
    } catch (const base::Error&) {
      ++refused;
    }
  }

  void end_a_session(int station) {
    Store store(path(station), sqlite::Open::Write);
    const auto runs = store.open_runs();
    if (runs.empty()) return;
    const OpenSession& session = runs[chance_.below(runs.size())].sessions.front();
    const bool leaves = chance_.uniform() < 0.6;
    dropouts += leaves ? 1 : 0;
    store.end_session(session.id, {leaves ? EarlyEnd::DroppedOut : EarlyEnd::Stopped, ""}, 900);
  }

  void withdraw_somebody(int station) {
    std::string code;
    {
      sqlite::Connection database(path(station), sqlite::Open::Read);
      code = database.text("SELECT participant FROM session ORDER BY participant LIMIT 1");
    }
    if (!code.empty()) withdraw(path(station), code);
  }

  void reserve(int station, int wanted) {
    Store store(path(station), sqlite::Open::Write);
    cutting([&] { reserve_block(store, *connection(station, true)(), request(wanted)); });
  }

  void give_back(int station) {
    Store store(path(station), sqlite::Open::Write);
    cutting([&] { settle_slots(store, *connection(station, true)(), "centre", true); });
  }

  void push(int station) {
    cutting([&] {
      centre_.push(station, path(station));
      Store store(path(station), sqlite::Open::Write);
      settle_slots(store, *connection(station, true)(), "centre");
    });
  }

  template <class Work>
  void cutting(Work work) {
    try {
      work();
    } catch (const ServerUnreachable&) {
      ++cuts;
    }
  }

  SlotCentre& centre_;
  RandomStream chance_;
  Protocol protocol_;
  test::TemporaryFolder folder_;
  double cuts_ = 0.12;
};

/// Lets a history happen, then checks what must hold of it.
inline void check_slot_history(SlotCentre& centre, std::uint64_t seed, int steps, int& people) {
  SlotHistory history(centre, seed);
  for (int i = 0; i < steps; ++i) {
    history.step();
    if (i % 16 == 0) {
      ASSERT_EQ(history.doubled(), "") << "after step " << i;
    }
  }
  history.reconcile();
  ASSERT_EQ(centre.open_reservations(), 0) << "no gap";
  history.fill();
  ASSERT_EQ(history.doubled(), "");
  const auto uses = history.uses();
  EXPECT_EQ(std::set<int>(uses.begin(), uses.end()).size(), 1u) << "every slot is used equally often";
  EXPECT_GT(history.offline + history.cuts + history.refused, 0) << "the histories meet no cut";
  people += history.people;
}

}  // namespace study::test
