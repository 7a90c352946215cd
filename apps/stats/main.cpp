/// vip-stats: analyses a database; writes results, verdicts on hypotheses and the file of fitted constants
/// that the solver reads.

#include <cstdio>

#include "apps/common/program.hpp"
#include "apps/stats/commands.hpp"
#include "libstudy/store/remote/central_study.hpp"
#include "stats/base/streams.hpp"

int main(int argc, char** argv) {
  study::read_central_studies(
      [](const std::string& line) { std::fprintf(stderr, "%s\n", base::for_terminal(line).c_str()); });
  const auto app = apps::new_program("Statistics of ViP-Lab studies", "vip-stats");
  apps::add_fit_ptpe_command(*app);
  apps::add_fit_people_command(*app);
  apps::add_compare_models_command(*app);
  apps::add_task_commands(*app);
  apps::add_report_command(*app);
  apps::add_study_command(*app);
  apps::add_preregister_command(*app);
  apps::add_power_command(*app);
  apps::add_scale_command(*app);
  return apps::run_program(*app, argc, argv);
}
