#include <CLI/CLI.hpp>

#include "apps/common/program.hpp"
#include "apps/view/options.hpp"
#include "apps/view/overlay.hpp"
#include "libsim/methods/method.hpp"

namespace {

std::string joined(const std::vector<std::string>& words) {
  std::string out;
  for (const auto& word : words) out += (out.empty() ? "" : ", ") + word;
  return out;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Any scene, any method, as pictures or live", "vip-view"};
  apps::ViewOptions options;
  std::string size = "1280x720";
  app.add_option("scene", options.scene, "Scene file")->required();
  app.add_flag("--headless", options.headless, "No window: run the frames and write pictures");
  app.add_option("--method", options.method, sim::method_names())->capture_default_str();
  app.add_option("--n-star", options.n_star, "Particles when all are coarsest; k = 1,024")
      ->capture_default_str();
  app.add_option("--preset", options.preset, "Readings of the paper: tuned or paper")->capture_default_str();
  app.add_option("--levels", options.levels, "N: levels of methods that split and merge (1 to 4)")
      ->capture_default_str();
  app.add_option("--alpha", options.alpha,
                 "Weight of the temporal feature, 0 to 1; the preset's when left out")
      ->check(apps::number_in(0, 1));
  app.add_option("--iterations", options.iterations,
                 "Constraint projections a substep; the scene's when left out")
      ->check(CLI::Range(1, sim::LiveNumbers::most_iterations));
  app.add_option("--overlay", options.overlay,
                 "Painted over the water: " + joined(apps::overlay_names()) +
                     "; headless, several with commas make a picture each")
      ->capture_default_str();
  app.add_option("--tau", options.tau, "tau of temporal acceleration, frames/s: live or fixed:X")
      ->capture_default_str();
  app.add_option("--backend", options.backend, "cpu, cuda or auto")->capture_default_str();
  app.add_option("--frames", options.frames, "Frames to run (headless)")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  app.add_option("--png", options.png_folder, "Folder for frame_0000.png ... (headless); made when missing")
      ->check(apps::output_folder());
  app.add_option("--every", options.every, "A picture every so many frames")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  app.add_option("--size", size, "Picture or window, px")->capture_default_str();
  app.add_option("--camera", options.camera, "view or overview")
      ->check(CLI::IsMember({"view", "overview"}))
      ->capture_default_str();
  app.add_option("--ptpe", options.ptpe,
                 "fitted.toml of vip-stats fit-ptpe: tau and beta at the measured frame rate");
  app.add_flag("--explain", options.explain, "Print each pass of the solver with why it runs");
  app.callback([&] {
    options.size = apps::parse_picture_size(size);
    if (options.headless) {
      apps::run_headless(options);
    } else {
      apps::run_window(options);
    }
  });
  return apps::run_program(app, argc, argv);
}
