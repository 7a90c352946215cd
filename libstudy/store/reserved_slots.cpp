#include "libstudy/store/reserved_slots.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "libstudy/store/open_study.hpp"
#include "stats/base/file.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

namespace {

constexpr std::array slot_states{"asked", "held", "returning", "returned"};

constexpr const char* reserved_slots_sql =
    "SELECT r.token, r.place, r.service, r.protocol_sha256, r.slots, r.block, r.slot, r.state, r.asked_utc, "
    "(SELECT min(s.participant) FROM session s JOIN protocol p USING (protocol_id) "
    "WHERE s.reservation = r.token || '.' || r.place AND s.test_data = p.test_data "
    "AND s.state IN ('open', 'done', 'stopped')), "
    "EXISTS (SELECT 1 FROM session s WHERE s.reservation = r.token || '.' || r.place) "
    "FROM reserved_slot r ORDER BY r.asked_utc, r.token, r.place";

SlotState slot_state_of(const std::string& word) {
  const auto found = std::find(slot_states.begin(), slot_states.end(), word);
  return static_cast<SlotState>(found - slot_states.begin());
}

std::vector<ReservedSlot> reserved_slots_in(sqlite::Connection& database) {
  std::vector<ReservedSlot> out;
  for (Statement row(database, reserved_slots_sql); row.step();) {
    ReservedSlot one;
    one.token = row.text(0);
    one.place = static_cast<int>(row.integer(1));
    one.service = row.text(2);
    one.protocol_sha256 = row.text(3);
    one.slots = static_cast<int>(row.integer(4));
    one.block = row.integer(5) != 0;
    if (!row.is_null(6)) one.slot = static_cast<int>(row.integer(6));
    one.state = slot_state_of(row.text(7));
    one.asked_utc = row.text(8);
    if (!row.is_null(9)) one.taken_by = row.text(9);
    one.given_up = row.integer(10) != 0 && one.taken_by.empty();
    out.push_back(std::move(one));
  }
  return out;
}

bool is_of(const ReservedSlot& one, const std::string& service) { return one.service == service; }

/// True if a push returns the slot: no session has it, and none will take it while the network is away.
bool gives_back(const ReservedSlot& one) { return one.is_free() && (!one.block || one.given_up); }

bool is_for(const ReservedSlot& one, const SlotRequest& request) {
  return one.service == request.service && one.protocol_sha256 == request.protocol_sha256;
}

/// Sends every request again of which a slot is not known.
int repeat_requests(Store& store, SlotServer& server, const std::string& service) {
  std::map<std::string, SlotRequest> open;
  for (const ReservedSlot& one : store.reserved_slots()) {
    if (!is_of(one, service) || one.state != SlotState::Asked) continue;
    auto& request = open[one.token];
    request = {service, one.protocol_sha256, one.slots, request.wanted, one.block};
    request.wanted = std::max(request.wanted, one.place + 1);
  }
  int answered = 0;
  for (const auto& [token, request] : open) {
    store.hold_slots(token, server.reserve(token, request));
    answered += request.wanted;
  }
  return answered;
}

void append_free(const std::vector<ReservedSlot>& all, const SlotRequest& request, bool block,
                 std::vector<DealtSlot>& out) {
  for (const ReservedSlot& one : all) {
    if (static_cast<int>(out.size()) == request.wanted) return;
    if (is_for(one, request) && one.block == block && one.is_free()) out.push_back({one.slot, one.name()});
  }
}

std::vector<DealtSlot> deal_online(Store& store, SlotServer& server, const SlotRequest& request) {
  repeat_requests(store, server, request.service);
  std::vector<DealtSlot> out;
  append_free(store.reserved_slots(), request, false, out);
  const int missing = request.wanted - static_cast<int>(out.size());
  if (missing == 0) return out;
  SlotRequest rest = request;
  rest.wanted = missing;
  rest.block = false;
  const std::string token = store.ask_slots(rest);
  const auto slots = server.reserve(token, rest);
  store.hold_slots(token, slots);
  for (std::size_t place = 0; place < slots.size(); ++place)
    out.push_back({slots[place], token + "." + std::to_string(place)});
  return out;
}

/// Without the server, and `why`.
std::vector<DealtSlot> deal_offline(Store& store, const SlotRequest& request, const ServerUnreachable& why) {
  std::vector<DealtSlot> out;
  const auto all = store.reserved_slots();
  append_free(all, request, false, out);
  append_free(all, request, true, out);
  if (static_cast<int>(out.size()) == request.wanted) return out;
  throw base::Error("service " + request.service,
                    why.problem() + ", and of the slots that were reserved in advance " +
                        std::to_string(out.size()) + " are left for " + std::to_string(request.wanted) +
                        " sessions",
                    "connect this computer; next time run vip-study slots reserve while it is connected, so "
                    "that slots are at hand");
}

}  // namespace

std::vector<ReservedSlot> Store::reserved_slots() { return reserved_slots_in(*database_); }

std::vector<ReservedSlot> read_reserved_slots(const StudyFile& study) {
  return reserved_slots_in(*open_study(study).database);
}

std::string Store::ask_slots(const SlotRequest& request) {
  Transaction transaction(*database_);
  const std::string token = database_->text("SELECT lower(hex(randomblob(16)))");
  Statement insert(*database_, "INSERT INTO reserved_slot VALUES (?,?,?,?,?,?,NULL,'asked',?)");
  for (int place = 0; place < request.wanted; ++place)
    insert
        .bind_all(token, place, request.service, request.protocol_sha256, request.slots,
                  request.block ? 1 : 0, base::utc_now())
        .run();
  commit(transaction);
  keep_file();
  return token;
}

void Store::hold_slots(const std::string& token, const std::vector<int>& slots) {
  Transaction transaction(*database_);
  Statement count(*database_, "SELECT count(*) FROM reserved_slot WHERE token = ?");
  count.bind_all(token).step();
  const std::int64_t wanted = count.integer(0);
  count.reset();
  if (wanted != static_cast<std::int64_t>(slots.size()))
    throw base::Error(path_.string(),
                      "asked for " + std::to_string(wanted) + " slots, and the central database gave " +
                          std::to_string(slots.size()),
                      "upgrade it: vip-study central upgrade");
  Statement hold(*database_,
                 "UPDATE reserved_slot SET slot = ?3, state = 'held' WHERE token = ?1 AND place = ?2");
  for (std::size_t place = 0; place < slots.size(); ++place)
    hold.bind_all(token, static_cast<std::int64_t>(place), slots[place]).run();
  commit(transaction);
}

void Store::release_slots(std::span<const ReservedSlot> slots) { set_slot_state(slots, "returning"); }

void Store::forget_slots(std::span<const ReservedSlot> slots) { set_slot_state(slots, "returned"); }

void Store::set_slot_state(std::span<const ReservedSlot> slots, const char* state) {
  Transaction transaction(*database_);
  Statement update(*database_, "UPDATE reserved_slot SET state = ?3 WHERE token = ?1 AND place = ?2");
  for (const ReservedSlot& one : slots) update.bind_all(one.token, one.place, state).run();
  commit(transaction);
}

std::vector<DealtSlot> deal_slots(Store& store, const SlotConnection& connect, const SlotRequest& request,
                                  std::string& offline) {
  offline.clear();
  try {
    return deal_online(store, *connect(), request);
  } catch (const ServerUnreachable& why) {
    auto slots = deal_offline(store, request, why);
    offline = why.problem();
    return slots;
  }
}

std::vector<int> reserve_block(Store& store, SlotServer& server, const SlotRequest& request) {
  repeat_requests(store, server, request.service);
  SlotRequest block = request;
  block.block = true;
  const std::string token = store.ask_slots(block);
  const auto slots = server.reserve(token, block);
  store.hold_slots(token, slots);
  return slots;
}

bool needs_settling(const std::vector<ReservedSlot>& slots, const std::string& service) {
  return std::any_of(slots.begin(), slots.end(), [&](const ReservedSlot& one) {
    if (!is_of(one, service) || one.state == SlotState::Returned) return false;
    return one.state != SlotState::Held || gives_back(one);
  });
}

SettledSlots settle_slots(Store& store, SlotServer& server, const std::string& service, bool all) {
  SettledSlots done;
  done.answered = repeat_requests(store, server, service);
  std::vector<ReservedSlot> free;
  for (ReservedSlot& one : store.reserved_slots()) {
    if (is_of(one, service) && (gives_back(one) || (all && one.is_free()))) free.push_back(std::move(one));
  }
  if (!free.empty()) store.release_slots(free);
  std::map<std::string, std::vector<ReservedSlot>> returning;
  for (ReservedSlot& one : store.reserved_slots()) {
    if (is_of(one, service) && one.state == SlotState::Returning)
      returning[one.token].push_back(std::move(one));
  }
  for (const auto& [token, slots] : returning) {
    std::vector<int> places;
    for (const ReservedSlot& one : slots) places.push_back(one.place);
    server.give_back(token, places);
    store.forget_slots(slots);
    done.returned += static_cast<int>(slots.size());
  }
  return done;
}

}  // namespace study
