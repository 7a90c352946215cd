#include "apps/study/station_warnings.hpp"

#include <cstdio>

#include "libstudy/console/database_place.hpp"
#include "libstudy/console/preflight.hpp"
#include "libstudy/console/progress.hpp"
#include "stats/base/file.hpp"
#include "stats/base/streams.hpp"
#include "stats/base/utc.hpp"

namespace apps {

namespace {

constexpr std::int64_t back_s = 60, ahead_s = std::int64_t{366} * 86'400;

std::vector<std::string> check_window_station(study::Store& store, const study::OpenSession& session,
                                              const study::Protocol& protocol,
                                              const study::SessionSetup& setup,
                                              const std::filesystem::path& database) {
  const auto bytes = study::expected_bytes(protocol, session.units);
  const auto judged = study::judge_preflight(setup.screen, study::read_station(database), bytes);
  const std::string lines = study::format_preflight(judged);
  std::fprintf(stderr, "%s", lines.c_str());
  store.log(session.id, "preflight", lines, setup.clock->now_ns());
  std::vector<std::string> warnings;
  for (const study::PreflightLine& line : judged) {
    if (line.readiness == study::Readiness::Warn) warnings.push_back(line.what + ": " + line.finding);
  }
  return warnings;
}

}  // namespace

std::string clock_problem(const std::string& now, const std::string& newest, const std::string& built) {
  const std::string mend =
      "\n  mend: set the clock (timedatectl set-ntp true) and start again; or continue: the record keeps the "
      "order of events, and vip-stats report names the times that it does not use";
  const std::string told = "the clock of this computer says " + now;
  if (now < built) return told + ", which is before this program was built, on " + built.substr(0, 10) + mend;
  const auto now_s = base::seconds_of_utc(now), newest_s = base::seconds_of_utc(newest);
  if (!now_s || !newest_s) return {};
  if (*now_s < *newest_s - back_s)
    return told + ", which is before the newest row of the database, of " + newest +
           ": it is wrong now, or it was wrong then" + mend;
  if (*now_s > *newest_s + ahead_s)
    return told + ", which is more than a year after the newest row of the database, of " + newest + mend;
  return {};
}

std::vector<std::string> warn_of_station(study::Store& store, const std::filesystem::path& database) {
  std::vector<std::string> warnings = study::place_problems(database);
  if (const auto problem = clock_problem(base::utc_now(), store.newest_utc(), base::built_utc());
      !problem.empty())
    warnings.push_back(problem);
  for (const std::string& one : warnings)
    std::fprintf(stderr, "warning: %s\n", base::for_terminal(one).c_str());
  return warnings;
}

std::vector<std::string> check_station(study::Store& store, const study::OpenRun& run,
                                       const study::Protocol& protocol, const study::SessionSetup& setup,
                                       const std::filesystem::path& database) {
  std::vector<std::string> warnings;
  for (const std::string& one : setup.warnings) warnings.push_back(one.substr(0, one.find('\n')));
  std::vector<std::string> found;
  for (const study::OpenSession& session : run.sessions) {
    for (const std::string& one : setup.warnings)
      store.log(session.id, "station warning", one, setup.clock->now_ns());
    if (setup.screen) found = check_window_station(store, session, protocol, setup, database);
  }
  warnings.insert(warnings.end(), found.begin(), found.end());
  return warnings;
}

}  // namespace apps
