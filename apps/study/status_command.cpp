/// vip-study status: summarises a database.
#include <cstdio>
#include <map>
#include <memory>
#include <string>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/console/certificate.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

std::string state_of(const study::SessionRow& session) {
  if (session.state != "open") return session.state == "done" ? "complete" : session.state;
  return session.done > 0 ? "under way" : "planned";
}

/// The permissions that the participant gave or refused; omits permissions without an answer.
std::string permissions_of(const study::SessionRow& session) {
  std::string text;
  if (session.gaze) text += *session.gaze ? ", gaze kept" : ", gaze not kept";
  if (session.sharing) text += *session.sharing ? ", data shared" : ", data not shared";
  return text;
}

void print_session_row(const study::SessionRow& session) {
  std::printf(
      "  %-12s visit %d  %3lld of %lld trials, %lld of %lld steps, %lld cut short, %lld excluded  %-12s  %s "
      "clock, %s%s%s\n",
      base::shortened(session.participant).c_str(), session.visit, static_cast<long long>(session.answered),
      static_cast<long long>(session.trials), static_cast<long long>(session.done),
      static_cast<long long>(session.units), static_cast<long long>(session.interrupted),
      static_cast<long long>(session.excluded), state_of(session).c_str(), session.clock.c_str(),
      session.observer.empty() ? "person" : ("simulated " + base::shortened(session.observer)).c_str(),
      session.test_data ? ", test data" : "", permissions_of(session).c_str());
}

/// Says from which program and source a session was imported, and what its timing rests on.
void print_import(const study::SessionRow& session) {
  if (session.imported_from.empty()) return;
  std::printf("    imported from %s, SHA-256 of the source %s\n",
              base::shortened(session.imported_from).c_str(), base::shortened(session.source_sha256).c_str());
  const auto line = [](std::int64_t showings, const char* what) {
    if (showings > 0) std::printf("    %lld showings: %s\n", static_cast<long long>(showings), what);
  };
  line(session.showings - session.not_recorded,
       "frames imported; they had no schedule, so none counts as late");
  line(session.stated, "frame rates as the source states them; no frame recorded");
  line(session.not_recorded - session.stated, "timing not recorded");
}

/// Prints one line for each factor with the trials of each level, such as "hitch: h33 20 of 40, h50 20 of
/// 40". An adaptive procedure chooses levels during the session, so that only answered trials are counted.
void print_levels(const study::ProtocolRow& protocol, bool adaptive) {
  for (std::size_t f = 0; f < protocol.cells.front().levels.size(); ++f) {
    std::map<std::string, study::CellCount> counts;
    std::vector<std::string> order;
    for (const study::CellCount& cell : protocol.cells) {
      if (f >= cell.levels.size()) continue;
      const std::string& level = cell.levels[f].second;
      if (!counts.contains(level)) order.push_back(level);
      counts[level].trials += cell.trials;
      counts[level].answered += cell.answered;
    }
    std::string line;
    for (const std::string& level : order)
      line += (line.empty() ? "" : ", ") + base::shortened(level) + ' ' +
              std::to_string(counts[level].answered) +
              (adaptive ? "" : " of " + std::to_string(counts[level].trials));
    std::printf("  %s: %s trials answered\n", base::shortened(protocol.cells.front().levels[f].first).c_str(),
                line.c_str());
  }
}

/// Prints trials by level and timing by cell; nothing for a protocol without factors.
void print_cells(const study::StudyFile& file, const study::ProtocolRow& row) {
  if (row.cells.empty() || row.cells.front().levels.empty()) return;
  const auto protocol = study::parse_protocol(row.text, row.name, study::ProtocolUse::Stored);
  print_levels(row, protocol.design.procedure.has_value());
  const study::FpsMean mean = protocol.pacing.mean;
  const auto shown = study::read_certificate_of_protocol(file, row.id, mean);
  std::printf("%s", study::format_certificate(shown, mean, false).c_str());
}

void status(const std::string& database, bool incomplete) {
  const study::StudyStatus found = study::read_status({database, incomplete});
  print_lacking(database, found.lacking);
  for (const study::ProtocolRow& protocol : found.protocols) {
    std::printf("protocol %s version %s, hash %s%s\n", base::shortened(protocol.name).c_str(),
                base::shortened(protocol.version).c_str(),
                base::shortened(protocol.sha256.substr(0, 12)).c_str(),
                protocol.test_data ? " (test data)" : "");
    std::printf("  %lld sessions, %lld of %lld trials answered\n", static_cast<long long>(protocol.sessions),
                static_cast<long long>(protocol.answered), static_cast<long long>(protocol.trials));
    for (const study::SessionRow& session : found.sessions) {
      if (session.protocol_id != protocol.id) continue;
      print_session_row(session);
      print_import(session);
    }
    print_cells({database, incomplete}, protocol);
  }
  for (const std::string& code : found.withdrawn) std::printf("%s withdrew\n", code.c_str());
  for (const std::string& code : study::requested_withdrawals({database, incomplete}))
    std::printf("%s asked that all data be deleted: vip-study withdraw %s --db %s\n", code.c_str(),
                code.c_str(), database.c_str());
  std::printf("%lld frames recorded, %lld samples of gaze\n", static_cast<long long>(found.frames),
              static_cast<long long>(found.gaze));
}

}  // namespace

void add_status_command(CLI::App& app) {
  auto database = std::make_shared<std::string>();
  auto incomplete = std::make_shared<bool>(false);
  CLI::App& sub = *app.add_subcommand("status", "Say what a database holds and what is left to do");
  add_database(sub, *database);
  add_incomplete(sub, *incomplete);
  sub.callback([database, incomplete] { status(*database, *incomplete); });
}

}  // namespace apps
