#pragma once
/// The commands of vip-study, one per source file; each function adds its command to the program.

#include <array>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI
namespace study {
struct MarkerPulse;
}

namespace apps {

struct PlayOptions;

void add_check_command(CLI::App& app);
void add_reference_command(CLI::App& app);
void add_trace_command(CLI::App& app);
void add_certify_command(CLI::App& app);
void add_bake_command(CLI::App& app);
void add_run_command(CLI::App& app);
void add_resume_command(CLI::App& app);
void add_status_command(CLI::App& app);
void add_export_command(CLI::App& app);
void add_consent_command(CLI::App& app);
void add_withdraw_command(CLI::App& app);
void add_merge_command(CLI::App& app);
void add_import_command(CLI::App& app);
void add_salvage_command(CLI::App& app);
void add_slots_command(CLI::App& app);
void add_headset_command(CLI::App& app);
void add_markers_command(CLI::App& app);
void add_light_command(CLI::App& app);
void add_gaze_command(CLI::App& app);
void add_central_command(CLI::App& app);
void add_push_command(CLI::App& app);
void add_pull_command(CLI::App& app);

/// Adds a required option for the name of a service, through which PostgreSQL is reached.
CLI::Option* add_service(CLI::App& command, const char* name, std::string& service, const char* what);

/// Adds the options that run and resume share, such as --db and --console (PlayOptions).
void add_play_options(CLI::App& command, PlayOptions& options);
/// Adds --marker-pulse-ms. receiver: the option that it needs.
void add_marker_pulse(CLI::App& command, CLI::Option* receiver, study::MarkerPulse& pulse);
/// Why a text is no value of --gaze; empty: it is one.
std::string gaze_source_problem(const std::string& text);
/// Adds --gaze-turn, the fixed rotation of an outside eye tracker's rays (study::rotation_of()).
void add_gaze_turn(CLI::App& command, std::array<double, 3>& turn_deg);
/// After a push: returns slots that sessions gave up to the central database, and prints how many. Prints why
/// not if the database is in use; the next push does it then.
void return_slots_after_push(const std::string& database, const std::string& service);
/// Says on the standard error if gaze from an outside eye tracker crosses a network.
void tell_of_network(const std::string& gaze);

}  // namespace apps
