/// Part of salvage(): recomputes plans with lost rows, since they are a function of the remaining data.
#include "libstudy/design/plan.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/salvage/salvage_rows.hpp"
#include "stats/base/error.hpp"

namespace study::salvaging {

using sqlite::Connection;
using sqlite::Statement;

namespace {

struct Planned {
  std::int64_t session = 0, seed = 0;
  std::string participant, code, text, sha256;
  std::optional<double> trial_seconds;
  int slot = 0;
};

std::vector<Planned> sessions_of(Connection& database) {
  std::vector<Planned> all;
  Statement row(
      database,
      "SELECT s.session_id, s.seed, s.participant, s.code, p.text, p.sha256, p.trial_seconds, s.slot "
      "FROM session s JOIN protocol p USING (protocol_id)");
  while (row.step()) {
    Planned one{.session = row.integer(0),
                .seed = row.integer(1),
                .participant = row.text(2),
                .code = row.text(3),
                .text = row.text(4),
                .sha256 = row.text(5),
                .trial_seconds = {},
                .slot = static_cast<int>(row.integer(7))};
    if (!row.is_null(6)) one.trial_seconds = row.real(6);
    all.push_back(std::move(one));
  }
  return all;
}

/// Row number of position 0: the rows of a session are consecutive. None if no row is left or they are not.
std::optional<std::int64_t> first_row(Connection& database, const std::string& table, std::int64_t session) {
  Statement row(database, "SELECT min(" + table + "_id - position), max(" + table +
                              "_id - position), count(*) FROM " + table + " WHERE session_id = ?");
  if (!row.bind_all(session).step() || row.integer(2) == 0 || row.integer(0) != row.integer(1)) return {};
  return row.integer(0);
}

/// True if the remaining trials match this plan.
bool agrees(Connection& database, std::int64_t session, const Plan& plan) {
  Statement row(database,
                "SELECT position, first_cell, second_cell, schedule_seed FROM trial WHERE session_id = ?");
  for (row.bind_all(session); row.step();) {
    const auto position = static_cast<std::size_t>(row.integer(0));
    if (position >= plan.trials.size()) return false;
    const PlannedTrial& trial = plan.trials[position];
    const bool second = trial.second ? !row.is_null(2) && row.integer(2) == *trial.second : row.is_null(2);
    if (row.integer(1) != trial.first || !second ||
        row.integer(3) != static_cast<std::int64_t>(trial.schedule_seed))
      return false;
  }
  return true;
}

std::optional<Plan> plan_of(Connection& database, const Planned& session, const Protocol& protocol) {
  // A merge may change codes; the plan was made with one of the two.
  for (const std::string& code : {session.participant, session.code}) {
    Plan plan = make_plan(protocol, code, static_cast<std::uint64_t>(session.seed), session.slot);
    if (agrees(database, session.session, plan)) return plan;
  }
  return {};
}

void add_trials(Connection& database, std::int64_t session, std::int64_t first, const Plan& plan) {
  Statement insert(database,
                   "INSERT OR IGNORE INTO trial (trial_id, session_id, position, group_index, first_cell, "
                   "second_cell, schedule_seed, state, set_aside) VALUES (?,?,?,?,?,?,?,'planned',0)");
  for (const PlannedTrial& trial : plan.trials) {
    insert
        .bind_all(first + trial.position, session, trial.position, trial.group, trial.first, trial.second,
                  static_cast<std::int64_t>(trial.schedule_seed))
        .run();
  }
}

void add_units(Connection& database, std::int64_t session, std::int64_t first,
               std::optional<std::int64_t> first_trial, const Protocol& protocol, const Plan& plan) {
  Statement insert(database,
                   "INSERT OR IGNORE INTO unit (unit_id, session_id, position, block, block_index, kind, "
                   "trial_id, state) VALUES (?,?,?,?,?,?,?,'planned')");
  for (const PlannedUnit& unit : plan.units) {
    const Block& block = protocol.blocks.at(static_cast<std::size_t>(unit.block));
    std::optional<std::int64_t> trial;
    if (unit.trial && !first_trial) continue;
    if (unit.trial) trial = *first_trial + *unit.trial;
    insert
        .bind_all(first + unit.position, session, unit.position, block.id, unit.block,
                  block_kind_name(block.kind), trial)
        .run();
  }
}

}  // namespace

// A plan without any remaining row is not restored: the row numbers, to which answers refer, are unknown.
void Rebuild::complete_plans(bool units) {
  for (const Planned& session : sessions_of(target_)) {
    const auto first = first_row(target_, units ? "unit" : "trial", session.session);
    if (!first) continue;
    try {
      Protocol protocol =
          parse_protocol(session.text, "protocol of session " + std::to_string(session.session));
      if (session.trial_seconds) override_trial_seconds(protocol, *session.trial_seconds);
      if (protocol.sha256 != session.sha256) continue;
      const auto plan = plan_of(target_, session, protocol);
      if (plan && units)
        add_units(target_, session.session, *first, first_row(target_, "trial", session.session), protocol,
                  *plan);
      else if (plan)
        add_trials(target_, session.session, *first, *plan);
    } catch (const base::Error&) {
      // The protocol's format is no longer read: its plan is not completed.
    }
  }
}

}  // namespace study::salvaging
