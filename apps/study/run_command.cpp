/// vip-study run: plans sessions, stores the plan and plays the sessions.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "apps/study/live_rates.hpp"
#include "apps/study/session_player.hpp"
#include "apps/study/station_warnings.hpp"
#include "libsim/ptpe/ptpe_file.hpp"
#include "libstudy/observer/observer.hpp"
#include "libstudy/pages/headset/answer_ways.hpp"
#include "libstudy/protocol/find_protocol.hpp"
#include "libstudy/session/session.hpp"
#include "libstudy/store/central/postgres.hpp"
#include "libstudy/store/remote/slot_server.hpp"
#include "libstudy/trackers/eye_tracker.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/machine.hpp"
#include "stats/base/picture_size.hpp"
#include "stats/base/streams.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace fs = std::filesystem;

namespace {

struct RunCommand {
  std::string protocol;
  PlayOptions play;
  study::RunOptions run;
  int participants = 0;
  std::vector<std::string> codes;
  int visit = 1;
  std::int64_t seed = 0;
  std::optional<double> trial_seconds;
  std::string bake, ptpe;
  std::string slots_from;  ///< service of the central database that deals the slots; empty: this station does
  std::vector<std::string> settings;  ///< paths of setting files
  std::optional<base::PictureSize> size;
};

/// The codes of --participant; for an observer (simulated participants) without codes, P01, P02, ...
std::vector<std::string> participant_codes(const RunCommand& command, const study::Protocol& protocol) {
  if (!command.codes.empty()) return command.codes;
  if (command.run.observer.empty())
    throw base::Error("--participant", "is missing: no participant is named",
                      "write --participant P07 for a person, or --observer NAME for simulated participants");
  const int count = command.participants > 0 ? command.participants : protocol.participants;
  std::vector<std::string> codes;
  for (int i = 1; i <= count; ++i) codes.push_back((i < 10 ? "P0" : "P") + std::to_string(i));
  return codes;
}

/// Sets the defaults of display, clock and gaze. A person: a window in real time. An observer (simulated
/// participants): no display and the virtual clock, but real time if a window is requested. Gaze: "fixed"
/// with a display, else "none".
void choose_defaults(study::RunOptions& run) {
  const bool person = run.observer.empty();
  if (run.display.empty()) run.display = person ? "window" : "none";
  if (run.clock.empty()) run.clock = person || run.display == "window" ? "real" : "virtual";
  if (run.gaze.empty()) run.gaze = run.display == "none" ? "none" : "fixed";
}

/// Sets the size of the picture from --size. Without --size, a window fills the monitor, and other displays
/// have their default size.
void take_size(const std::optional<base::PictureSize>& size, study::RunOptions& run) {
  if (!size && run.display != "window") return;
  run.width_px = size ? size->width : 0;
  run.height_px = size ? size->height : 0;
}

study::Protocol read_checked_protocol(const RunCommand& command) {
  study::Protocol protocol = study::read_protocol(study::find_protocol(command.protocol));
  if (command.trial_seconds) study::override_trial_seconds(protocol, *command.trial_seconds);
  return protocol;
}

/// Reads the PTPE file of --ptpe. A session stores it, so that the curve of one person is refused for anybody
/// else: it would stay in their sessions after the person's withdrawal.
std::optional<std::string> read_ptpe(const std::string& path, const std::vector<std::string>& codes) {
  if (path.empty()) return {};
  const auto file = sim::read_ptpe_file(path);
  const auto other = std::find_if(codes.begin(), codes.end(),
                                  [&](const std::string& code) { return code != file.participant; });
  if (!file.participant.empty() && other != codes.end())
    throw base::Error(path,
                      "holds the curve of " + base::shortened(file.participant) + ", and would stay in " +
                          base::shortened(*other) + "'s session after a withdrawal",
                      "run it with --participant " + base::shortened(file.participant) +
                          " alone, or give the curve of all people, which vip-stats fit-ptpe writes");
  std::printf("%s: %s\n", path.c_str(), sim::describe(file).c_str());
  return base::read_file(path, 1 << 20);
}

/// Reads and checks the setting files one by one, so that an error names the wrong file.
std::vector<std::string> read_settings(const std::vector<std::string>& paths,
                                       const study::Protocol& protocol) {
  std::vector<std::string> texts;
  for (const std::string& path : paths) {
    texts.push_back(base::read_file(path, 1 << 20));
    study::SessionSettings({texts.back()}, protocol, path);
  }
  return texts;
}

study::SessionPlan common_plan(const RunCommand& command, const study::Protocol& protocol,
                               const study::SessionSetup& setup, const std::optional<std::string>& ptpe) {
  study::SessionPlan session;
  session.visit = command.visit;
  session.station_number = study::parse_station_number(command.run.station);
  session.seed = study::seed_of_station(static_cast<std::uint64_t>(command.seed), session.station_number);
  session.test_data = protocol.test_data || !setup.departure().empty() ||
                      (command.run.display == "openxr" && command.run.clock == "virtual");
  session.framing = study::framing_record(setup.scenes);
  session.observer = setup.participant->simulated();
  session.virtual_clock = setup.virtual_clock;
  session.display = setup.display->description();
  session.stimulus = setup.stimuli->description();
  session.machine = base::describe_machine();
  session.time_zone = base::local_time_zone();
  session.ptpe = ptpe;
  const bool fixation = protocol.fixation && command.run.gaze == "fixed";
  const bool outside = study::is_outside_tracker(command.run.gaze);
  session.gaze_source = fixation ? "fixation" : outside ? "tracked" : command.run.gaze;
  session.station = command.run.station;
  session.screen_width_mm = command.run.screen_width_mm;
  session.viewing_distance_mm = command.run.viewing_distance_mm;
  if (const double refresh_hz = setup.display->refresh_hz(); refresh_hz > 0) session.refresh_hz = refresh_hz;
  return session;
}

/// Slots that this station deals by itself: those that study::next_slot() returns.
std::vector<study::DealtSlot> own_slots(const study::Protocol& protocol, std::vector<int> taken,
                                        const std::optional<study::StationNumber>& number,
                                        std::size_t wanted) {
  std::vector<study::DealtSlot> out;
  while (out.size() < wanted) {
    taken.push_back(study::next_slot(protocol, taken, number));
    out.push_back({taken.back(), {}});
  }
  return out;
}

/// Slots of the assignment for this many sessions, from this station or from the central database.
std::vector<study::DealtSlot> slots_for(const RunCommand& command, study::Store& store,
                                        const study::Protocol& protocol,
                                        const std::optional<study::StationNumber>& number,
                                        std::size_t wanted) {
  if (command.slots_from.empty())
    return own_slots(protocol, store.taken_slots(protocol.sha256), number, wanted);
  std::string offline;
  const auto slots = study::deal_slots(
      store, [&] { return study::connect_slots(command.slots_from); },
      {command.slots_from, protocol.sha256, study::slot_count(protocol), static_cast<int>(wanted), false},
      offline);
  if (!offline.empty())
    std::fprintf(stderr, "service %s: %s; slots that were reserved in advance are used\n",
                 command.slots_from.c_str(), offline.c_str());
  return slots;
}

/// Plans a session for each participant, each at its slot.
study::RunPlan make_run_plan(const RunCommand& command, const study::Protocol& protocol,
                             study::SessionPlan session, const std::vector<std::string>& codes,
                             const std::vector<study::DealtSlot>& slots) {
  study::RunPlan run{protocol, study::format_run_options(command.run), {}};
  for (std::size_t i = 0; i < codes.size(); ++i) {
    session.participant = codes[i];
    session.plan = study::make_plan(protocol, codes[i], session.seed, slots[i].slot);
    session.reservation = slots[i].reservation;
    run.sessions.push_back(session);
  }
  return run;
}

/// Refuses a run without a station number if all earlier sessions of the protocol have one, because each
/// station assigns only its part of the slots. If this run has a station number that no earlier session has,
/// prints only a warning.
void check_station_number(study::Store& store, const study::Protocol& protocol,
                          const study::SessionPlan& common, const std::string& database) {
  std::optional<study::StationNumber> other;
  bool unnumbered = false;
  for (const auto& number : store.station_numbers(protocol.sha256)) {
    if (number == common.station_number) return;
    if (number) other = number;
    unnumbered = unnumbered || !number;
  }
  if (other && !common.station_number)
    throw base::Error(database,
                      "its sessions of protocol '" + protocol.name + "' are those of station " +
                          study::station_text(*other) + ", and this run has no station number",
                      "add --station " + study::station_text(*other) + ", or use another database");
  if (!other && !unnumbered) return;
  std::fprintf(
      stderr,
      "%s: warning: sessions of protocol '%s' were recorded here %s; this run is station %s: see the "
      "balance that vip-study merge prints\n",
      database.c_str(), protocol.name.c_str(),
      other ? ("as station " + study::station_text(*other)).c_str() : "without a station number",
      study::station_text(*common.station_number).c_str());
}

Played play_planned(const RunCommand& command, const study::Protocol& protocol,
                    const study::SessionPlan& common, const std::vector<std::string>& codes,
                    study::SessionSetup& setup) {
  study::Store store(command.play.database, study::sqlite::Open::Create, command.play.max_pages,
                     tell_of_locks(command.play.database));
  print_list("Still left of a withdrawal or a merge:", store.left_to_clean());
  setup.warnings = warn_of_station(store, command.play.database);
  check_station_number(store, protocol, common, command.play.database.string());
  const auto slots = slots_for(command, store, protocol, common.station_number, codes.size());
  const std::int64_t run_id = store.add_run(make_run_plan(command, protocol, common, codes, slots));
  Played played;
  for (const study::OpenRun& open : store.open_runs()) {
    if (open.id != run_id) continue;
    played.end = play_run(store, open, protocol, setup, command.play);
    print_certificate(command.play.database, open, protocol);
  }
  played.withdraw = store.requested_withdrawals();
  store.require_journal();
  study::check_nothing_left(command.play.database, store.left_to_clean());
  return played;
}

void run(RunCommand& command) {
  if (!command.slots_from.empty()) study::pg::check_service_name(command.slots_from);
  const study::Protocol protocol = read_checked_protocol(command);
  for (const std::string& scale : study::scales_beyond(command.run.observer, protocol))
    std::fprintf(stderr, "warning: %s: the observer gives the nearest score there\n", scale.c_str());
  choose_defaults(command.run);
  open_markers(command.play, command.run.clock == "virtual");
  take_size(command.size, command.run);
  if (!command.bake.empty()) command.run.bake = fs::absolute(base::find_input(command.bake)).string();
  const auto codes = participant_codes(command, protocol);
  for (const std::string& code : codes) study::check_participant_code(code);
  const auto ptpe = read_ptpe(command.ptpe, codes);
  command.run.settings = read_settings(command.settings, protocol);
  study::check_keys_are_free(command.run.answer, command.play.console);
  study::SessionSetup setup = study::make_session_setup(command.run, protocol, ptpe, command.ptpe);
  study::check_settings(protocol, *setup.display);
  open_mirror(command.play, setup);
  tell_of_patch(setup);
  setup.rates = check_live(protocol, setup, command.play.accept_slow);
  command.run.accept_slow = command.play.accept_slow;
  // The stored observer (simulated participant) is written with the defaults of this version, because another
  // version may have other defaults.
  command.run.observer = setup.participant->simulated().value_or("");
  tell_of_network(command.run.gaze);
  const study::SessionPlan common = common_plan(command, protocol, setup, ptpe);
  if (!setup.departure().empty())
    std::fprintf(stderr, "%s: shows %s; the data are marked as test data\n", command.bake.c_str(),
                 base::for_terminal(setup.departure()).c_str());
  for (const std::string& note : setup.stimuli->bakes().notes(command.protocol))
    std::fprintf(stderr, "%s: %s\n", command.bake.c_str(), base::for_terminal(note).c_str());
  for (const std::string& note : setup.stimuli->settings().notes(protocol))
    std::fprintf(stderr, "%s: %s\n", command.protocol.c_str(), base::for_terminal(note).c_str());
  for (const std::string& note : study::framing_notes(protocol, setup.scenes))
    std::fprintf(stderr, "%s: %s\n", command.protocol.c_str(), base::for_terminal(note).c_str());
  if (setup.gaze && !study::asks_gaze(protocol))
    std::fprintf(stderr, "%s: does not ask %s; gaze will not be recorded\n", command.protocol.c_str(),
                 study::gaze_question);
  const StopSignals signals;
  end_command(command.play.database, play_planned(command, protocol, common, codes, setup));
}

}  // namespace

void add_play_options(CLI::App& command, PlayOptions& options) {
  command.add_option("--db", options.database, "Database of the study")->required();
  command.add_option("--max-pages", options.max_pages, "Let the database grow to this many pages of 4 KiB")
      ->check(CLI::PositiveNumber);
  command.add_flag("--console", options.console,
                   "Experimenter's console in this terminal: plan, timing and keys to steer the session");
  command.add_flag("--accept-slow", options.accept_slow,
                   "Also play live cells for which this station is too slow; live cells are measured before "
                   "the session, once for a station and build");
  command.add_flag("--events", options.events,
                   "Print a line for each step of a session once it is stored, without answers");
  auto* mirror = command.add_flag("--mirror", options.mirror,
                                  "Show the experimenter the participant's pages in a second window (of a "
                                  "headset, the left eye's view); stimuli are black");
  command
      .add_flag("--mirror-reveal", options.mirror_reveal,
                "With --mirror: show stimuli too; this unblinds and is logged")
      ->needs(mirror);
  auto* markers = command.add_option(
      "--markers", options.markers,
      "Send markers of events to a recording system: serial:/dev/ttyUSB0[:BAUD] (one byte each), "
      "tcp:[HOST:]PORT (one line each) or lsl:NAME (Lab Streaming Layer); may be repeated. resume "
      "needs it again");
  markers->allow_extra_args(false);
  add_marker_pulse(command, markers, options.pulse);
}

void add_marker_pulse(CLI::App& command, CLI::Option* receiver, study::MarkerPulse& pulse) {
  command
      .add_option(
          "--marker-pulse-ms", pulse.ms,
          "Time after which a serial marker's byte returns to 0, ms; 0: never, for boxes that make the "
          "pulse themselves")
      ->check(CLI::Range(0, 200))
      ->capture_default_str()
      ->needs(receiver);
}

void add_run_command(CLI::App& app) {
  auto command = std::make_shared<RunCommand>();
  CLI::App& sub = *app.add_subcommand("run", "Run a protocol and keep everything in a database");
  sub.add_option("protocol", command->protocol,
                 "Protocol file, or the name of one that comes with the program, such as task1")
      ->required();
  add_play_options(sub, command->play);
  sub.get_option("--db")->check(output_file());
  auto* count = sub.add_option("--participants", command->participants,
                               "Run P01, P02, ... (default: as many as the protocol plans)");
  count->check(CLI::Range(1, 9999));
  sub.add_option("--participant", command->codes, "Code of a participant; may be repeated")->excludes(count);
  add_count(sub, "--visit", command->visit, 1, 1000, "Visit of these participants under this protocol");
  sub.add_option(
      "--observer", command->run.observer,
      "Simulated observer: ptpe:a=31,b=0.035, detect:hitch_ms,threshold=80, frames, random, constant:4 or "
      "dropout:0.2; without: a person");
  sub.add_option("--clock", command->run.clock,
                 "Play in real time (default of a person), or without waiting (default of an observer)")
      ->check(CLI::IsMember({"real", "virtual"}));
  sub.add_option("--display", command->run.display,
                 "Where frames go: a window (default of a person), drawn without a window, a headset by "
                 "OpenXR, or nowhere (default of an observer)")
      ->check(CLI::IsMember({"window", "headless", "openxr", "none"}));
  sub.add_option("--answer", command->run.answer,
                 "How a person answers in a headset, separated by commas: ray (point with the hand), stick, "
                 "dwell (look at it for a second), keyboard (of this terminal); default: ray,stick,keyboard");
  sub.add_flag(
      "--ignore-presence", command->run.ignore_presence,
      "Do not ask the headset's software whether the headset is worn, because its reports are wrong");
  sub.add_option("--gaze", command->run.gaze,
                 "Where the participant is assumed to look: the middle of the picture, the mouse, the head's "
                 "direction, the headset's eye tracker (recorded if gaze_kept is answered with yes), or not "
                 "known; tracked without a headset: an observer's gaze, as if a tracker had measured it. "
                 "tcp:[HOST:]PORT or lsl:NAME (Lab Streaming Layer): an eye tracker outside OpenXR")
      ->check(&gaze_source_problem);
  add_gaze_turn(sub, command->run.gaze_turn_deg);
  sub.add_option("--station", command->run.station,
                 "Name of the station, kept with the sessions. A number at its end, 2/5 or \"lab2 2/5\" for "
                 "station 2 of 5, gives the station its own share of the assignment and its own orders")
      ->check(text_up_to(100));
  sub.add_option("--slots-from", command->slots_from,
                 "Take slots of the assignment from a central database, named by its section in libpq's "
                 "service file; while it cannot be reached, from those of vip-study slots reserve")
      ->type_name("SERVICE");
  add_viewing(sub, command->run.screen_width_mm, command->run.viewing_distance_mm,
              "Width of the participant's picture on the screen: with the distance it gives visual angles");
  add_size(sub, command->size,
           "Pixels of the display (default: 640x360 without a window; a window fills the monitor)");
  add_count(sub, "--monitor", command->run.monitor, 0, 15,
            "Monitor of a window that fills it; 0: the primary one");
  sub.add_option("--seed", command->seed, "Seed of orders, schedules and observers")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  sub.add_option("--trial-seconds", command->trial_seconds,
                 "Length of every trial; changes the protocol's hash and marks the data as test");
  sub.add_option(
      "--stimulus", command->bake,
      "Bake to play (vip-study bake), or folder of bakes (vip-study bake --protocol), of which stimuli "
      "without a bake run live; without this option: live fluid, or nothing with --display none");
  add_backend(sub, command->run.backend, "Computes live fluid");
  sub.add_flag("--light-patch", command->run.light_patch,
               "Draw a small square in the lower left corner that is white and black with every other frame "
               "of a stimulus, for a light sensor that covers it (vip-study light); kept with the sessions");
  sub.add_option("--ptpe", command->ptpe, "PTPE file to use; stored with the sessions");
  sub.add_option(
         "--setting", command->settings,
         "best.toml of vip-bench accuracy --budget: all numbers of the solver for the live cells of its "
         "method and n_*, kept with the sessions; may be repeated, for other methods or sizes")
      ->allow_extra_args(false);
  sub.footer(exit_status_help);
  sub.callback([command] { run(*command); });
}

}  // namespace apps
