/// vip-bench frame: milliseconds per frame of one scene and method, with the density error that results.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <type_traits>
#include <variant>

#include "apps/bench/commands.hpp"
#include "apps/bench/frame.hpp"
#include "apps/bench/table_options.hpp"
#include "apps/common/options.hpp"
#include "libsim/measure/cells.hpp"
#include "libsim/measure/launch_table.hpp"
#include "libsim/measure/peers.hpp"
#include "libsim/measure/render_timer.hpp"
#include "libsim/measure/timed_run.hpp"
#include "libsim/scene/scene.hpp"
#include "libsim/setting/setting_file.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/machine.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

constexpr const char* floors_help =
    "--passes holds each pass against memory. least MB: what a frame's launches of the pass must move, each\n"
    "input read once and each output written once; of cells, grids and columns that only some methods have\n"
    "nothing is counted. Lists of neighbours are as long as in the mean of the measured states. Where\n"
    "temporal acceleration lets particles rest, passes over the solved ones count these alone. floor: these\n"
    "bytes over the bandwidth of a copy of 256 MiB within the back end's memory, read plus written. times\n"
    "floor: measured time over it. What a cache still holds moves faster: with few particles a pass may "
    "take\n"
    "less than its floor. - stands where nothing is known.";

void add_solver_numbers(CLI::App& command, sim::SimulationOptions& fluid) {
  for (const sim::SolverNumber& number : sim::solver_numbers()) {
    std::visit(
        [&](auto member) {
          using Number = std::remove_reference_t<decltype(fluid.*member)>;
          auto* option = command.add_option("--" + std::string(number.name), fluid.*member, number.help);
          if constexpr (std::is_integral_v<Number>)
            option->check(CLI::Range(static_cast<int>(number.least), static_cast<int>(number.most)));
          else
            option->check(number_in(number.least, number.most));
        },
        number.value);
  }
  for (const char* follows_speed : {"--courant", "--most-substeps"})
    command.get_option(follows_speed)->excludes(command.get_option("--substeps"));
}

void print_frame(const base::Json& result) {
  std::printf("%s %s n_* %s on %s: %lld particles, %d frames\n", result["scene"].get<std::string>().c_str(),
              result["method"].get<std::string>().c_str(), result["n_star"].get<std::string>().c_str(),
              result["backend"].get<std::string>().c_str(), result["particles"].get<long long>(),
              result["frames"].get<int>());
  std::printf("  solve        %8.3f ms a frame (median), %.3f mean, %.3f p95, %.3f p99\n",
              result["solve_ms_median"].get<double>(), result["solve_ms_mean"].get<double>(),
              result["solve_ms_p95"].get<double>(), result["solve_ms_p99"].get<double>());
  if (result.contains("render_left_out")) {
    std::printf("  render       left out: %s\n", result["render_left_out"].get<std::string>().c_str());
  } else {
    measure::print_render_figures(result);
    std::printf(
        "  frame        %8.3f ms (median), %.3f p95, %.3f p99: solve, transfer and render one after "
        "another\n",
        result["frame_ms_median"].get<double>(), result["frame_ms_p95"].get<double>(),
        result["frame_ms_p99"].get<double>());
  }
  std::printf("  h/d          %8.3f\n  neighbours   %8.2f mean within h\n", result["h_over_d"].get<double>(),
              result["neighbours_mean"].get<double>());
  std::printf("  density      %8.4f %% mean of max(rho/rho_0 - 1, 0), max rho/rho_0 %.3f\n",
              100 * result["density_error_mean"].get<double>(), result["density_max"].get<double>());
  const auto& temporal = result["temporal"];
  std::printf(
      "  substeps     %8.2f a frame on average, %d at most; %d frames asked for more than were allowed\n",
      result["substeps_mean"].get<double>(), result["substeps_most"].get<int>(),
      result["frames_short_of_substeps"].get<int>());
  std::printf("  temporal     tau %s frames/s (%s), beta %.3f, %.2f %% of the particles solved\n",
              temporal["tau_fps"].is_null() ? "unknown" : temporal["tau_fps"].dump().c_str(),
              temporal["tau_given"].get<std::string>().c_str(), temporal["beta"].get<double>(),
              100 * temporal["solved_share_mean"].get<double>());
  std::printf("%s", measure::in_words(result["effects"]).c_str());
  std::printf("  guards       %s\n", result["guards"].dump().c_str());
  if (const auto& first = result["divergence"]; !first.is_null())
    std::printf("  divergence   %s\n", first["in_words"].get<std::string>().c_str());
  if (!result["bandwidth_gb_s"].is_null())
    std::printf("%s",
                measure::launch_lines(result["launches"], result["bandwidth_gb_s"].get<double>()).c_str());
}

// The scene, method, n_* and step at which the rows of data/peers.csv were measured.
constexpr const char* peers_scene = "data/scenes/peers_dam.toml";
constexpr const char* peers_method = "HiRes";
constexpr const char* peers_n_star = "4k";
constexpr double peers_dt_s = 0.005;

/// Refuses all options but `allowed` beside --peers, which fixes the conditions of the run.
void refuse_beside_peers(const CLI::App& command) {
  constexpr std::array allowed{"--peers",  "--backend", "--frames",     "--warm-up",      "--no-render",
                               "--passes", "--json",    "--save-state", "--measure-every"};
  for (const CLI::Option* option : command.get_options()) {
    const auto is = [&](const char* name) { return option->check_name(name); };
    if (option->count() > 0 && std::none_of(allowed.begin(), allowed.end(), is))
      throw CLI::ExcludesError("--peers", option->get_name());
  }
}

/// Runs the fixed scene, method, n_* and step at which the rows of data/peers.csv were measured (constants
/// above). These values and "no picture" replace those in `options`; the other options apply. Prints our
/// figures beside the rows.
base::Json run_peers(FrameOptions options) {
  const auto peers = measure::read_peers(base::find_input("data/peers.csv"));
  options.scene = peers_scene;
  options.method = peers_method;
  options.n_star = peers_n_star;
  options.fluid.frame_dt_s = peers_dt_s;
  options.no_render = true;
  const sim::Scene scene = sim::read_scene(base::find_input(options.scene));
  base::Json result = run_frames(options);
  // Empty on a GPU, because describe_machine() names only the processor.
  const std::string machine = result["backend"] == "cpu" ? base::describe_machine() : "";
  const measure::OurRow ours = measure::our_row(result, peers_dt_s, scene.solver_iterations, machine);
  print_frame(result);
  std::printf("\n%s\n%s\n", figures::to_markdown(measure::peers_table(peers, ours)).c_str(),
              measure::peers_note(peers, ours).c_str());
  result["machine"] = machine.empty() ? base::Json() : base::Json(machine);
  result["peers"] = measure::to_json(peers);
  return result;
}

/// Refuses all options but `allowed` beside --setting, which fixes all numbers of the solver.
void refuse_beside_setting(const CLI::App& command) {
  constexpr std::array allowed{"scene",       "--setting", "--backend",      "--frames", "--warm-up",
                               "--no-render", "--passes",  "--look",         "--size",   "--views",
                               "--surface",   "--json",    "--measure-every"};
  for (const CLI::Option* option : command.get_options()) {
    const auto is = [&](const char* name) { return option->check_name(name); };
    if (option->count() > 0 && std::none_of(allowed.begin(), allowed.end(), is))
      throw CLI::ExcludesError("--setting", option->get_name());
  }
}

void take_setting(FrameOptions& options) {
  const sim::SettingFile file = sim::read_setting_file(options.setting);
  const auto scene = sim::read_scene(base::find_input(options.scene));
  std::printf("%s\n", sim::describe(file).c_str());
  if (const auto note = sim::other_scene(file, scene.sha256); !note.empty())
    std::printf("%s\n", note.c_str());
  options.fluid = sim::to_options(file.setting, sim::Backend::Cpu, 1);
  options.method = sim::method_name(options.fluid.method);
  options.n_star = std::to_string(options.fluid.n_star);
  if (const auto tau = options.fluid.temporal.fixed_tau) options.tau = "fixed:" + base::shortest(*tau);
}

base::Json run(const FrameOptions& options) {
  if (options.peers) return run_peers(options);
  base::Json result = run_frames(options);
  print_frame(result);
  return result;
}

}  // namespace

void add_frame_command(CLI::App& app) {
  auto options = std::make_shared<FrameOptions>();
  auto* command = app.add_subcommand("frame", "Milliseconds a frame of one scene and method");
  command->footer(floors_help);
  command->add_option("scene", options->scene, "Scene file")->capture_default_str();
  add_method(*command, options->method);
  add_n_star(*command, options->n_star);
  add_backend(*command, options->backend);
  auto* tau = command->add_option("--tau", options->tau, "Tolerance of Ours-TSp: live or fixed:X in frames/s")
                  ->capture_default_str();
  command
      ->add_option("--rate", options->rate,
                   "Mean and standard deviation of the frame rate that its tau follows from, as in a study's "
                   "cell: 16.9,3.2")
      ->excludes(tau);
  command->add_option("--ptpe", options->ptpe, ptpe_help);
  command->add_option(
      "--setting", options->setting,
      "best.toml of vip-bench accuracy --budget: method, sizes and all numbers of the solver");
  command->add_flag("--temporal", options->fluid.temporal.always,
                    "Temporal acceleration also for a method without it");
  add_count(*command, "--frames", options->frames, 1, 100000, "Timed frames");
  add_count(*command, "--warm-up", options->warm_up, 0, 10000, "Untimed frames before");
  add_solver_numbers(*command, options->fluid);
  command
      ->add_option("--resume", options->fluid.resume_from,
                   "Go on from a state that --save-state wrote, with the same scene and options")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--save-state", options->save_state, "Write the state after the last frame to this file")
      ->check(output_file());
  add_count(*command, "--measure-every", options->measure_every, 0, 100000,
            "Measure the density every so many frames, untimed; 0 = some ten times");
  command->add_flag(
      "--passes", options->passes,
      "Also time every launch of the solver (slows it down) and hold it against the memory's bandwidth");
  auto* no_render = command->add_flag("--no-render", options->no_render, "Time the solver alone");
  command
      ->add_flag("--look", options->look,
                 "Let the method see each picture and its middle, as in a live session; handing it over "
                 "counts as solve")
      ->excludes(no_render);
  add_size(*command, options->size, "Picture of one view, px");
  add_count(*command, "--views", options->views, 1, 2, "1, or 2 eyes side by side");
  command->add_option("--surface", options->surface, "Particles are drawn as ellipsoids or spheres")
      ->check(CLI::IsMember({"ellipsoids", "spheres"}))
      ->capture_default_str();
  command->add_option("--json", options->json, "Also write the figures to this file")->check(output_file());
  command->add_flag("--peers", options->peers,
                    "Run PeersDam with 32,768 particles, HiRes and steps of 0.005 s, without pictures, and "
                    "print it beside other programs' times at that setting");
  command->callback([options, command] {
    if (options->peers) refuse_beside_peers(*command);
    options->fluid.temporal.model = load_model(options->ptpe);
    if (!options->setting.empty()) {
      refuse_beside_setting(*command);
      take_setting(*options);
    }
    const auto result = run(*options);
    if (!options->json.empty()) base::write_file_atomically(options->json, result.dump(2) + "\n");
  });
}

}  // namespace apps
