#pragma once
/// The commands of vip-stats. Each function has its own file and adds its command or commands to the program.

namespace CLI {
class App;
}

namespace apps {

void add_compare_models_command(CLI::App& app);
void add_fit_ptpe_command(CLI::App& app);
void add_fit_people_command(CLI::App& app);
/// Adds task1 and task2.
void add_task_commands(CLI::App& app);
void add_report_command(CLI::App& app);
void add_study_command(CLI::App& app);
void add_preregister_command(CLI::App& app);
void add_power_command(CLI::App& app);
void add_scale_command(CLI::App& app);

}  // namespace apps
