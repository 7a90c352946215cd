#include <CLI/CLI.hpp>
#include <cstdio>

#include "apps/common/options.hpp"
#include "apps/common/program.hpp"
#include "apps/view/options.hpp"
#include "apps/view/overlay.hpp"
#include "libsim/scene/reference.hpp"
#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

int main(int argc, char** argv) {
  CLI::App app{"Show a scene with any method, live or as pictures", "vip-view"};
  apps::ViewOptions options;
  app.add_option("scene", options.scene, "Scene file")->required();
  bool headless = false;
  auto* headless_flag = app.add_flag("--headless", headless, "As --display headless");
  app.add_option(
         "--display", options.display,
         "window; headless: run the frames and write pictures; openxr: a headset, or a window where there "
         "is none")
      ->check(CLI::IsMember({"window", "headless", "openxr"}))
      ->capture_default_str()
      ->excludes(headless_flag);
  app.add_option("--clock", options.clock,
                 "Of a headset: real, or virtual for runtimes whose time waits for the program")
      ->check(CLI::IsMember({"real", "virtual"}))
      ->capture_default_str();
  std::vector<CLI::Option*> of_setting{apps::add_method(app, options.method),
                                       apps::add_n_star(app, options.n_star)};
  of_setting.push_back(app.add_option("--preset", options.preset, "Readings of the paper: tuned or paper")
                           ->capture_default_str());
  of_setting.push_back(
      app.add_option("--levels", options.levels, "N: levels of methods that split and merge (1 to 4)")
          ->capture_default_str());
  of_setting.push_back(app.add_option("--alpha", options.alpha,
                                      "Weight of the temporal feature, 0 to 1; the preset's when left out")
                           ->check(apps::number_in(0, 1)));
  of_setting.push_back(app.add_option("--iterations", options.iterations,
                                      "Constraint projections a substep; the scene's when left out")
                           ->check(CLI::Range(1, sim::LiveNumbers::most_iterations)));
  app.add_option("--overlay", options.overlay,
                 "Painted over the water: " + base::joined(apps::overlay_names()) +
                     "; headless, several separated by commas make one picture each")
      ->capture_default_str();
  of_setting.push_back(
      app.add_option("--tau", options.tau, "tau of temporal acceleration, frames/s: live or fixed:X")
          ->capture_default_str());
  apps::add_backend(app, options.backend);
  app.add_option("--frames", options.frames, "Frames to run, headless (default: 100) or in a headset")
      ->check(CLI::Range(1, 10'000));
  app.add_option("--png", options.png_folder, "Folder for frame_0000.png ... (headless); made when missing")
      ->check(apps::output_folder());
  apps::add_count(app, "--every", options.every, 1, 10'000, "Write a picture every this many frames");
  apps::add_size(app, options.size, "Picture or window, px");
  app.add_option("--surface", options.surface, "Particles are drawn as ellipsoids or spheres")
      ->check(CLI::IsMember({"ellipsoids", "spheres"}))
      ->capture_default_str();
  app.add_option("--camera", options.camera, "view or overview")
      ->check(CLI::IsMember({"view", "overview"}))
      ->capture_default_str();
  of_setting.push_back(app.add_option(
      "--ptpe", options.ptpe, "fitted.toml of vip-stats fit-ptpe: tau and beta at the measured frame rate"));
  std::string setting_file;
  auto* setting =
      app.add_option("--setting", setting_file,
                     "best.toml of vip-bench accuracy --budget: method, sizes and all numbers of the solver");
  for (CLI::Option* option : of_setting) setting->excludes(option);
  std::string sweep;
  app.add_option("--sweep", sweep,
                 "Sweep file of vip-bench accuracy: prints the cost and error of the current setting, "
                 "compared with HiRes");
  app.add_option(
      "--effects-off", options.effects_off,
      "Effects of the scene to switch off, together with those that need them: kinds separated by commas");
  app.add_flag_callback(
      "--reference",
      [] {
        std::fputs(sim::scene_reference_page().c_str(), stdout);
        throw CLI::Success();
      },
      "Print every key of a scene file, as Markdown");
  app.add_flag("--explain", options.explain, "Print each pass of the solver with why it runs");
  app.callback([&] {
    if (headless) options.display = "headless";
    if (!setting_file.empty()) apps::take_setting(options, setting_file);
    if (!sweep.empty())
      options.sweep = std::make_shared<const study::SweepTables>(study::read_sweep_tables(sweep));
    if (options.clock == "virtual" && options.display != "openxr")
      throw base::Error("--clock virtual", "is for a headset", "leave it out, or use --display openxr");
    if (options.display == "headless") return apps::run_headless(options);
    if (options.display == "openxr") return apps::run_in_headset(options);
    apps::run_window(options);
  });
  return apps::run_program(app, argc, argv);
}
