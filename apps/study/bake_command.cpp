/// vip-study bake: compute the frames of a scene beforehand, and check such files.
#include "libsim/bake/bake_file.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <memory>

#include "apps/common/finite_water.hpp"
#include "apps/common/fluid_picture.hpp"
#include "apps/common/picture_size.hpp"
#include "apps/common/program.hpp"
#include "apps/study/commands.hpp"
#include "apps/study/session_player.hpp"
#include "libsim/render/gl_context.hpp"
#include "libsim/render/offscreen.hpp"
#include "libsim/scene/gaze.hpp"
#include "libsim/scene/settled_state.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace apps {

namespace {

struct BakeCommand {
  std::string scene, out, verify;
  std::string method = "HiRes", n_star = "32k", backend = "auto";
  std::string pictures, camera = "view";
  std::int64_t frames = 600;
  double content_step_s = 0;
  bool force = false;
};

/// Draws frames into a framebuffer of its own and reads them back as a bake keeps them: bottom row first.
class PictureTaker {
 public:
  PictureTaker(const sim::Scene& scene, const sim::Camera& camera, int width_px, int height_px)
      : context_(sim::GlContext::make_headless()),
        picture_of_fluid_(scene),
        target_(width_px, height_px),
        view_(sim::make_view(camera, width_px, height_px)) {}

  void look(sim::Simulation& fluid, const sim::Gaze& gaze) { picture_of_fluid_.look(fluid, view_, gaze); }

  const std::vector<std::uint8_t>& take(sim::Simulation& fluid) {
    picture_of_fluid_.draw(fluid, view_, target_.framebuffer());
    picture_ = target_.read().rgba;
    const auto row = static_cast<std::ptrdiff_t>(4 * target_.width());
    for (auto top = picture_.begin(), bottom = picture_.end() - row; top < bottom;
         top += row, bottom -= row) {
      std::swap_ranges(top, top + row, bottom);
    }
    return picture_;
  }

 private:
  sim::GlContext context_;
  FluidPicture picture_of_fluid_;
  sim::Offscreen target_;
  sim::View view_;
  std::vector<std::uint8_t> picture_;
};

void stop_if_wished(const std::string& out) {
  if (StopSignals::stop_wished()) {
    throw base::Error(out, "stopped on request; no file was written", "run the same command again");
  }
}

/// Everything that is to be known before the first frame is written.
struct Work {
  sim::Scene scene;
  std::unique_ptr<PictureTaker> pictures;
  std::unique_ptr<sim::Simulation> simulation;
  sim::BakeHeader header;
};

void fill_header(const BakeCommand& command, const sim::SimulationOptions& options, Work& work) {
  sim::BakeHeader& h = work.header;
  h.scene_name = work.scene.name;
  h.scene_sha256 = work.scene.sha256;
  h.method = sim::method_name(options.method);
  h.backend = sim::backend_name(options.backend);
  h.program_version = base::version();
  h.n_star = options.n_star;
  h.max_particles = work.simulation->particle_capacity();
  h.frame_count = command.frames;
  h.frame_dt_s = options.frame_dt_s;
  h.tank_size_m = work.scene.tank_size_m;
  h.radius_by_level_m = work.simulation->radii_m();
  if (h.has_pictures()) h.camera = command.camera;
}

/// Refuses what can be refused, then fills and settles the scene.
Work prepare(const BakeCommand& command) {
  Work work;
  const auto path = base::find_input(command.scene);
  work.header.scene_text = base::read_file(path, 1 << 20);
  work.scene = sim::parse_scene(work.header.scene_text, path.string());
  sim::SimulationOptions options;
  options.method = sim::parse_method(command.method);
  options.n_star = sim::parse_n_star(command.n_star);
  options.backend = sim::choose_backend(command.backend);
  options.frame_dt_s = command.content_step_s > 0 ? command.content_step_s : work.scene.frame_dt_s;
  sim::BakeWriter::check_target(command.out, command.force);
  PictureSize size;
  if (!command.pictures.empty()) size = parse_picture_size(command.pictures, "--pictures");
  work.header.picture_width_px = size.width;
  work.header.picture_height_px = size.height;
  if (work.header.has_pictures()) {
    const sim::Camera& camera = command.camera == "overview" ? work.scene.overview : work.scene.view;
    work.pictures = std::make_unique<PictureTaker>(work.scene, camera, size.width, size.height);
  }
  std::unique_ptr<Progress> progress;
  options.settling = [&](int done, int total) {
    stop_if_wished(command.out);
    if (!progress) progress = std::make_unique<Progress>("settling", static_cast<std::size_t>(total));
    progress->update(static_cast<std::size_t>(done));
  };
  options.cache = sim::default_cache_folder();
  work.simulation = sim::make_simulation(work.scene, options);
  fill_header(command, options, work);
  return work;
}

void print_sizes(const std::string& out, const sim::BakeSizes& sizes) {
  const sim::BakeReader bake(out);
  const sim::BakeHeader& h = bake.header();
  const auto frames = static_cast<double>(h.frame_count);
  std::printf("%s: %lld frames of %s%lld particles, %.0f bytes a frame for particles", out.c_str(),
              static_cast<long long>(h.frame_count), h.radius_by_level_m.size() > 1 ? "up to " : "",
              static_cast<long long>(h.max_particles), static_cast<double>(sizes.particle_bytes) / frames);
  if (h.has_pictures()) {
    std::printf(" and %.0f for the picture", static_cast<double>(sizes.picture_bytes) / frames);
  }
  std::printf("; %.1f MB in all; bake %s\n", 1e-6 * static_cast<double>(sizes.file_bytes),
              bake.content_hash().c_str());
}

/// Levels that follow a gaze follow the scene's own, and the pictures where there are any.
void look(Work& work, const sim::Camera& camera, int frame) {
  const sim::Gaze gaze = gaze_at(camera, sim::gaze_point(work.scene, frame));
  if (work.pictures) return work.pictures->look(*work.simulation, gaze);
  work.simulation->look({{{gaze, sim::make_view(camera, 1280, 720)}}});
}

void bake(const BakeCommand& command) {
  const StopSignals signals;
  Work work = prepare(command);
  const sim::Camera& camera = command.camera == "overview" ? work.scene.overview : work.scene.view;
  sim::BakeWriter writer(command.out, work.header, command.force);
  Progress progress("bake", static_cast<std::size_t>(command.frames));
  std::vector<sim::RenderParticle> particles;
  for (std::int64_t frame = 0; frame < command.frames; ++frame) {
    stop_if_wished(command.out);
    if (frame > 0) {
      look(work, camera, static_cast<int>(frame));
      work.simulation->step_frame();
    }
    work.simulation->read_particles(particles);
    writer.add_frame(static_cast<double>(frame) * work.header.frame_dt_s, particles,
                     work.simulation->account());
    if (work.pictures) writer.add_picture(work.pictures->take(*work.simulation));
    progress.update(static_cast<std::size_t>(frame + 1));
  }
  check_finite(*work.simulation, command.out);
  print_sizes(command.out, writer.finish());
}

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Calls read(frame) for all frames; frames a second.
template <typename Read>
double read_all(const char* label, std::int64_t frames, Read read) {
  Progress progress(label, static_cast<std::size_t>(frames));
  const double start_s = seconds_now();
  for (std::int64_t frame = 0; frame < frames; ++frame) {
    read(frame);
    progress.update(static_cast<std::size_t>(frame + 1));
  }
  return static_cast<double>(frames) / std::max(1e-9, seconds_now() - start_s);
}

void verify(const std::string& path) {
  const sim::BakeReader bake(path);
  const sim::BakeHeader& h = bake.header();
  sim::BakeFrame frame;
  const double particles = read_all("particles", h.frame_count, [&](auto i) { bake.read_frame(i, frame); });
  std::printf("%s: %s, %s, n_* %lld, on %s, bake %s: all %lld frames are whole\n", path.c_str(),
              h.scene_name.c_str(), h.method.c_str(), static_cast<long long>(h.n_star), h.backend.c_str(),
              bake.content_hash().c_str(), static_cast<long long>(h.frame_count));
  std::printf("  %s%lld particles a frame read, checked and decoded at %.0f frames/s\n",
              h.radius_by_level_m.size() > 1 ? "up to " : "", static_cast<long long>(h.max_particles),
              particles);
  if (!h.has_pictures()) return;
  sim::PictureReader reader(bake);
  const double pictures = read_all("pictures", h.frame_count, [&](auto i) { reader.read(i); });
  std::printf("  %dx%d pictures (%s) read, checked and decoded at %.0f frames/s\n", h.picture_width_px,
              h.picture_height_px, h.camera.c_str(), pictures);
}

}  // namespace

void add_bake_command(CLI::App& app) {
  auto command = std::make_shared<BakeCommand>();
  CLI::App& sub = *app.add_subcommand("bake", "Compute the frames of a scene into a file, or check one");
  auto* scene = sub.add_option("scene", command->scene, "Scene file");
  auto* out = sub.add_option("--out", command->out, "Bake file to write");
  sub.add_option("--method", command->method, sim::method_names())->capture_default_str();
  sub.add_option("--n-star", command->n_star, "Particles when all are coarsest; k = 1,024")
      ->capture_default_str();
  sub.add_option("--frames", command->frames, "Content steps to compute")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  sub.add_option("--content-step", command->content_step_s,
                 "Fluid time between frames, s; default: the scene's")
      ->check(number_in(1e-6, 1));
  sub.add_option("--pictures", command->pictures, "Keep pictures of this size too, such as 640x360");
  sub.add_option("--camera", command->camera, "Camera of the pictures")
      ->check(CLI::IsMember({"view", "overview"}))
      ->capture_default_str();
  sub.add_option("--backend", command->backend, "Computes the fluid")
      ->check(CLI::IsMember({"cpu", "cuda", "auto"}))
      ->capture_default_str();
  sub.add_flag("--force", command->force, "Replace the output when it exists");
  auto* check = sub.add_option("--verify", command->verify, "Read this bake and check every frame");
  check->excludes(scene)->excludes(out);
  sub.callback([command] {
    if (!command->verify.empty()) return verify(command->verify);
    if (command->scene.empty()) throw CLI::RequiredError("scene");
    if (command->out.empty()) throw CLI::RequiredError("--out");
    bake(*command);
  });
}

}  // namespace apps
