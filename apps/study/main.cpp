#include <cstdio>

#include "apps/common/program.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/store/remote/central_study.hpp"
#include "stats/base/streams.hpp"

int main(int argc, char** argv) {
  study::read_central_studies(
      [](const std::string& line) { std::fprintf(stderr, "%s\n", base::for_terminal(line).c_str()); });
  const auto app = apps::new_program("Studies of people's perception of real-time fluid", "vip-study");
  apps::add_check_command(*app);
  apps::add_headset_command(*app);
  apps::add_reference_command(*app);
  apps::add_trace_command(*app);
  apps::add_certify_command(*app);
  apps::add_bake_command(*app);
  apps::add_markers_command(*app);
  apps::add_gaze_command(*app);
  apps::add_light_command(*app);
  apps::add_run_command(*app);
  apps::add_resume_command(*app);
  apps::add_status_command(*app);
  apps::add_export_command(*app);
  apps::add_consent_command(*app);
  apps::add_withdraw_command(*app);
  apps::add_merge_command(*app);
  apps::add_central_command(*app);
  apps::add_push_command(*app);
  apps::add_pull_command(*app);
  apps::add_import_command(*app);
  apps::add_salvage_command(*app);
  apps::add_slots_command(*app);
  return apps::run_program(*app, argc, argv);
}
