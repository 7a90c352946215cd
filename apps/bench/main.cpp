#include "apps/bench/commands.hpp"
#include "apps/common/program.hpp"

int main(int argc, char** argv) {
  const auto app = apps::new_program("What accuracy costs in time", "vip-bench");
  apps::add_accuracy_command(*app);
  apps::add_effects_command(*app);
  apps::add_frame_command(*app);
  apps::add_growth_command(*app);
  apps::add_headset_command(*app);
  apps::add_stability_command(*app);
  apps::add_surface_command(*app);
  apps::add_table1_command(*app);
  apps::add_table2_command(*app);
  return apps::run_program(*app, argc, argv);
}
