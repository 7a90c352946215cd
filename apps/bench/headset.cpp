#include <epoxy/gl.h>
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <array>
#include <memory>
#include <numeric>
#include <string>
#include <thread>
#include <vector>

#include "apps/bench/commands.hpp"
#include "apps/common/options.hpp"
#include "apps/common/program.hpp"
#include "libsim/measure/render_timer.hpp"
#include "libsim/setting/finite_water.hpp"
#include "libsim/simulation.hpp"
#include "libstudy/headset/headset_session.hpp"
#include "libstudy/headset/system.hpp"
#include "libstudy/stimulus/fluid_stimulus.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/timing.hpp"

namespace apps {

namespace {

constexpr std::chrono::seconds most_idle{30};

struct HeadsetBenchOptions {
  study::StimulusChoice fluid;
  std::string scene = "data/scenes/single_dam.toml";
  std::string json;
  int frames = 300, warm_up = 30;
  bool passes = false;
};

/// Milliseconds of each stage of a frame, one value per frame: computing the fluid, drawing both eyes,
/// handing the picture to the runtime, and all three. A stage ends when the GPU is idle.
struct Stages {
  std::vector<double> step, draw, hand_over, whole;
  measure::PassTable passes = {};
};

/// Computes a step of the fluid and draws it for both eyes in every frame slot, one stage after another.
class HeadsetBench {
 public:
  explicit HeadsetBench(const HeadsetBenchOptions& options)
      : gl_(study::make_headset_context()), session_(gl_) {
    const base::PictureSize size = session_.picture_size();
    picture_ = std::make_unique<sim::Offscreen>(size.width, size.height);
    study::StimulusChoice choice = options.fluid;
    choice.scene = base::find_input(options.scene);
    choice.render.time_passes = options.passes;
    fluid_ = study::make_live_fluid(choice);
    fluid_->start(0);
    const auto since = std::chrono::steady_clock::now();
    while (!session_.running()) {
      session_.poll();
      if (std::chrono::steady_clock::now() - since > most_idle)
        throw base::Error("headset",
                          fmt::format("the runtime did not begin a session within {} s", most_idle.count()),
                          "put the headset on and give the command again");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  void run(int frames, Stages* stages) {
    for (int i = 0; i < frames; ++i) {
      session_.poll();
      if (!session_.running())
        throw base::Error("headset", "the runtime ended the session before all frames were timed",
                          "keep the headset on until the command ends");
      one_frame(stages);
    }
  }

  void print_guards() const { sim::print_guards(fluid_->description(), fluid_->simulation()); }
  base::Json facts() const {
    const study::HeadsetRate rate = session_.rate();
    return {{"headset", session_.description()}, {"refresh_hz", rate.measured_hz},
            {"fluid", fluid_->description()},    {"particles", fluid_->simulation().particle_count()},
            {"drawn_by", sim::gl_description()}, {"dropped_slots", session_.meter().dropped()}};
  }

 private:
  void one_frame(Stages* stages) {
    const study::HeadsetSlot slot = session_.wait();
    session_.begin(slot);
    const double begun = base::milliseconds_now();
    fluid_->prepare(++step_);
    fluid_->simulation().synchronize();
    const double stepped = base::milliseconds_now();
    const study::EyeViews views = session_.views(slot);
    const std::array<study::EyeView, 2> eyes{study::study_view(views[0], 0),
                                             study::study_view(views[1], views[0].width_px)};
    if (study::can_be_shown(views))
      fluid_->draw({picture_->framebuffer(), picture_->width(), picture_->height(), eyes});
    glFinish();
    const double drawn = base::milliseconds_now();
    session_.end(slot, {.picture = picture_.get(), .views = views});
    glFinish();
    const double over = base::milliseconds_now();
    if (!stages) return;
    stages->step.push_back(stepped - begun);
    stages->draw.push_back(drawn - stepped);
    stages->hand_over.push_back(over - drawn);
    stages->whole.push_back(over - begun);
    stages->passes.add(fluid_->pass_times());
  }

  sim::GlContext gl_;
  study::HeadsetSession session_;
  std::unique_ptr<sim::Offscreen> picture_;
  std::unique_ptr<study::LiveFluid> fluid_;
  std::int64_t step_ = 0;
};

base::Json figures_of(const std::vector<double>& ms) {
  const double mean = std::accumulate(ms.begin(), ms.end(), 0.0) / static_cast<double>(ms.size());
  return {{"mean_ms", mean}, {"p95_ms", base::quantile(ms, 0.95)}, {"p99_ms", base::quantile(ms, 0.99)}};
}

void print_stage(const char* name, const base::Json& figures) {
  fmt::print("  {:<10} {:8.3f} mean {:8.3f} p95 {:8.3f} p99\n", name, figures["mean_ms"].get<double>(),
             figures["p95_ms"].get<double>(), figures["p99_ms"].get<double>());
}

void run_headset(const HeadsetBenchOptions& options) {
  HeadsetBench bench(options);
  Stages stages;
  bench.run(options.warm_up, nullptr);
  bench.run(options.frames, &stages);
  bench.print_guards();
  base::Json result = bench.facts();
  result["program"] = "vip-bench headset";
  result["version"] = base::version();
  result["frames"] = options.frames;
  result["stages"] = {{"step", figures_of(stages.step)},
                      {"draw", figures_of(stages.draw)},
                      {"hand_over", figures_of(stages.hand_over)},
                      {"whole", figures_of(stages.whole)}};
  if (options.passes) result["passes"] = stages.passes.figures();
  fmt::print("{}\n{}, {} particles, {} frames, ms:\n", result["headset"].get<std::string>(),
             result["fluid"].get<std::string>(), result["particles"].get<std::int64_t>(), options.frames);
  for (const char* stage : {"step", "draw", "hand_over", "whole"})
    print_stage(stage, result["stages"][stage]);
  if (options.passes) {
    fmt::print("  passes of both eyes, medians\n");
    measure::print_passes(result["passes"]);
  }
  if (!result["refresh_hz"].is_null())
    fmt::print("  period     {:8.3f} at {:.2f} Hz\n", 1e3 / result["refresh_hz"].get<double>(),
               result["refresh_hz"].get<double>());
  if (!options.json.empty()) base::write_file_atomically(options.json, result.dump(2) + "\n");
}

}  // namespace

void add_headset_command(CLI::App& app) {
  auto options = std::make_shared<HeadsetBenchOptions>();
  auto* command = app.add_subcommand(
      "headset", "Milliseconds a frame of live fluid in an OpenXR headset: step, both eyes, hand-over");
  command->add_option("scene", options->scene, "Scene file")->capture_default_str();
  add_method(*command, options->fluid.method);
  add_n_star(*command, options->fluid.n_star);
  add_backend(*command, options->fluid.backend);
  add_count(*command, "--frames", options->frames, 1, 100000, "Timed frames");
  add_count(*command, "--warm-up", options->warm_up, 0, 10000, "Untimed frames before");
  command->add_flag("--passes", options->passes,
                    "Also time each pass of the renderer, on the device's clock");
  command->add_option("--json", options->json, "Also write the figures to this file")->check(output_file());
  command->callback([options] { run_headset(*options); });
}

}  // namespace apps
