/// vip-study resume: finishes the open sessions of a database.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <memory>

#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "apps/study/live_rates.hpp"
#include "apps/study/session_player.hpp"
#include "apps/study/station_warnings.hpp"
#include "libstudy/pages/headset/answer_ways.hpp"
#include "libstudy/session/interruptions.hpp"
#include "libstudy/stimulus/bakes/session_bakes.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/machine.hpp"
#include "stats/base/streams.hpp"

namespace apps {

namespace {

struct ResumeOptions {
  PlayOptions play;
  std::vector<std::string> settings, stimuli;  ///< setting files; bakes (files or folders)
};

/// Parses a stored protocol. base::Error if this version no longer reads the protocol's format.
study::Protocol read_again(const study::OpenRun& run, const std::string& place) {
  try {
    return study::parse_protocol(run.protocol_text, "protocol " + run.protocol_name,
                                 study::ProtocolUse::Stored);
  } catch (const base::Error& error) {
    const std::string reason = error.what();
    throw base::Error(
        place, "cannot be resumed: " + reason.substr(0, reason.find('\n')),
        "finish the sessions with the version of vip-study that began them; if this version upgraded the "
        "database, use its copy with the ending .bak; it can still be read by status, export and vip-stats");
  }
}

/// The protocol from its text in the database. base::Error if its hash differs from the stored hash.
study::Protocol rebuild_protocol(const study::OpenRun& run, const std::string& place) {
  study::Protocol protocol = read_again(run, place);
  if (run.trial_seconds) study::override_trial_seconds(protocol, *run.trial_seconds);
  if (protocol.sha256 != run.protocol_sha256) {
    throw base::Error(place,
                      "protocol '" + run.protocol_name + "' has the SHA-256 " +
                          protocol.sha256.substr(0, 12) + ", and " + run.protocol_sha256.substr(0, 12) +
                          " is stored with it",
                      "restore a backup of the database, or use the version of vip-study that wrote it");
  }
  return protocol;
}

/// Refuses a solver setting that differs from the recorded settings of the sessions.
void check_settings(const std::vector<std::string>& files, const study::RunOptions& recorded,
                    const std::string& place) {
  for (const std::string& file : files) {
    const std::string text = base::read_file(file, 1 << 20);
    if (std::find(recorded.settings.begin(), recorded.settings.end(), text) != recorded.settings.end())
      continue;
    std::string own;
    for (const std::string& one : recorded.settings)
      own += (own.empty() ? "" : ", ") + base::sha256_hex(one).substr(0, 12);
    throw base::Error("--setting " + file,
                      "is not a setting with which the sessions of " + place +
                          " began (SHA-256 recorded: " + (own.empty() ? "no setting" : own) +
                          "; of this file: " + base::sha256_hex(text).substr(0, 12) + ")",
                      "leave it out: resume takes the recorded setting");
  }
}

/// Refuses stimuli that differ from the recorded stimuli, and a display on which a session would become test
/// data. Another machine, display or framing is allowed: stores machine, display and framing with each
/// session.
void check_unchanged(study::Store& store, const study::OpenRun& run, const study::SessionSetup& setup,
                     const std::string& place) {
  for (const study::OpenSession& session : run.sessions) {
    if (session.plan.stimulus != setup.stimuli->description()) {
      throw base::Error(place,
                        "participant " + session.plan.participant + " was shown '" + session.plan.stimulus +
                            "', which is now '" + setup.stimuli->description() + "'",
                        "put the same bake or scene back in its place, or name the bake with --stimulus");
    }
    if (const std::string departure = setup.departure(); !departure.empty() && !session.plan.test_data) {
      throw base::Error(place,
                        "participant " + session.plan.participant + " would be shown " + departure +
                            " on this display, which makes test data",
                        "resume on the display where the session began");
    }
    store.add_framing(session.id, study::framing_record(setup.scenes));
    store.log(session.id, "resumed", base::describe_machine() + "; display " + setup.display->description(),
              setup.clock->now_ns());
  }
}

/// The recorded options of each run, with the present path of its bake.
std::vector<study::RunOptions> recorded_options(const std::vector<study::OpenRun>& runs,
                                                const std::vector<std::string>& stimuli,
                                                const std::string& place) {
  if (runs.empty()) return {};
  std::vector<study::RunOptions> all;
  std::vector<study::RecordedBake> bakes;
  for (const study::OpenRun& run : runs) {
    all.push_back(study::parse_run_options(run.options, place));
    bakes.push_back({all.back().bake, run.sessions.front().plan.stimulus});
  }
  const std::vector<std::string> paths = study::find_bakes(bakes, stimuli, place);
  for (std::size_t i = 0; i < all.size(); ++i) all[i].bake = paths[i];
  return all;
}

/// Warns of a session that sent markers before and now does not.
void warn_of_missing_markers(study::Store& store, const study::OpenRun& run, const PlayOptions& options) {
  for (const study::OpenSession& session : run.sessions) {
    for (const std::string& receiver : store.marker_receivers(session.id)) {
      if (std::any_of(options.markers.begin(), options.markers.end(),
                      [&](const std::string& given) { return study::same_marker_receiver(given, receiver); }))
        continue;
      std::fprintf(stderr,
                   "%s: warning: the session of %s sent markers to %s, and this command sends it none; "
                   "--markers must be given again\n",
                   options.database.c_str(), session.plan.participant.c_str(),
                   base::for_terminal(receiver).c_str());
    }
  }
}

Played play_rest(const ResumeOptions& resume) {
  PlayOptions options = resume.play;
  const std::string place = options.database.string();
  study::Store store(options.database, study::sqlite::Open::Write, options.max_pages,
                     tell_of_locks(options.database));
  print_list("Still left of a withdrawal or a merge:", store.left_to_clean());
  const auto warnings = warn_of_station(store, options.database);
  for (const study::OpenRun& run : store.open_runs()) {
    const study::Protocol protocol = rebuild_protocol(run, place);
    for (const auto& session : run.sessions) study::settle_interruption(store, protocol, session);
  }
  const auto runs = store.open_runs();
  Played played;
  if (runs.empty()) std::printf("%s: nothing is left to do\n", place.c_str());
  const auto recorded = recorded_options(runs, resume.stimuli, place);
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const study::OpenRun& run = runs[i];
    const study::RunOptions& chosen = recorded[i];
    const study::Protocol protocol = rebuild_protocol(run, place);
    check_settings(resume.settings, chosen, place);
    study::check_keys_are_free(chosen.answer, options.console);
    open_markers(options, chosen.clock == "virtual");
    warn_of_missing_markers(store, run, options);
    study::SessionSetup setup =
        study::make_session_setup(chosen, protocol, run.sessions.front().plan.ptpe, place, place);
    tell_of_network(chosen.gaze);
    setup.warnings = warnings;
    open_mirror(options, setup);
    tell_of_patch(setup);
    setup.rates = check_live(protocol, setup, options.accept_slow || chosen.accept_slow);
    check_unchanged(store, run, setup, place);
    played.end = std::max(played.end, play_run(store, run, protocol, setup, options));
    print_certificate(options.database, run, protocol);
  }
  played.withdraw = store.requested_withdrawals();
  store.require_journal();
  study::check_nothing_left(options.database, store.left_to_clean());
  return played;
}

void resume(const ResumeOptions& options) {
  const StopSignals signals;
  end_command(options.play.database, play_rest(options));
}

}  // namespace

void add_resume_command(CLI::App& app) {
  auto options = std::make_shared<ResumeOptions>();
  CLI::App& sub = *app.add_subcommand("resume", "Finish the sessions that were planned and not completed");
  add_play_options(sub, options->play);
  sub.add_option("--setting", options->settings,
                 "Setting file that must be one that the sessions began with; resume uses the recorded "
                 "settings in any case")
      ->allow_extra_args(false);
  sub.add_option("--stimulus", options->stimuli,
                 "New path of the bake or folder of bakes that the sessions began with, if it was moved; it "
                 "is recognised by its hash")
      ->allow_extra_args(false);
  sub.footer(exit_status_help);
  sub.callback([options] { resume(*options); });
}

}  // namespace apps
