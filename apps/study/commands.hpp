#pragma once
/// The commands of vip-study, one per source file; each function adds its command to the program.

namespace CLI {
class App;
class Option;
}
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
void add_headset_command(CLI::App& app);
void add_markers_command(CLI::App& app);
void add_light_command(CLI::App& app);

/// Adds the options that run and resume share, such as --db and --console (PlayOptions).
void add_play_options(CLI::App& command, PlayOptions& options);
/// Adds --marker-pulse-ms. receiver: the option that it needs.
void add_marker_pulse(CLI::App& command, CLI::Option* receiver, study::MarkerPulse& pulse);

}  // namespace apps
