/// vip-study bake: computes the frames of a scene, or of all stimuli of a protocol, in advance; checks such
/// files.
#include <cstdio>
#include <memory>

#include "apps/common/options.hpp"
#include "apps/study/bake_protocol.hpp"
#include "apps/study/commands.hpp"
#include "apps/study/session_player.hpp"
#include "libsim/ptpe/ptpe_file.hpp"
#include "libstudy/protocol/find_protocol.hpp"
#include "libstudy/runner/session_framing.hpp"
#include "libstudy/stimulus/bakes/write_bake.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"

namespace apps {

namespace {

struct BakeCommand {
  std::string scene, out, verify, protocol;
  std::string method = "HiRes", n_star = "32k", backend = "auto";
  std::string pictures, camera = "view", overlay = "none", surface, rate, ptpe;
  int frames = 600;
  double content_step_s = 0;
  bool force = false;
  // The options below apply only to --protocol.
  std::optional<base::PictureSize> size;
  std::string keep = "particles";
  std::optional<double> screen_width_mm, viewing_distance_mm;
};

stats::PtpeModel ptpe_model(const BakeCommand& command) {
  if (command.ptpe.empty()) return {};
  const auto file = sim::read_ptpe_file(command.ptpe);
  if (!file.participant.empty())
    throw base::Error(command.ptpe, "holds the curve of one person, which a bake would keep",
                      "give the curve of all people, which vip-stats fit-ptpe writes");
  return file.model;
}

study::BakeOrder order_of(const BakeCommand& command) {
  study::BakeOrder order;
  order.fluid.scene = base::find_input(command.scene);
  order.fluid.method = command.method;
  order.fluid.n_star = command.n_star;
  order.fluid.backend = command.backend;
  order.fluid.content_step_s = command.content_step_s;
  order.fluid.overview = command.camera == "overview";
  order.fluid.paint_temperature = command.overlay == "temperature";
  order.fluid.surface = command.surface;
  order.fluid.model = ptpe_model(command);
  if (!command.rate.empty()) order.fluid.fixed_rate = sim::parse_frame_rate(command.rate);
  order.frames = command.frames;
  order.pictures = !command.pictures.empty();
  if (order.pictures) order.size = base::parse_picture_size(command.pictures, "--pictures");
  order.scene_gaze = true;
  return order;
}

void print_sizes(const std::string& out, const sim::BakeSizes& sizes) {
  const sim::BakeReader bake(out);
  const sim::BakeHeader& h = bake.header();
  const auto frames = static_cast<double>(h.frame_count);
  std::printf("%s: %lld frames of %s%lld particles, %.0f bytes a frame for particles", out.c_str(),
              static_cast<long long>(h.frame_count), h.radius_by_level_m.size() > 1 ? "up to " : "",
              static_cast<long long>(h.max_particles), static_cast<double>(sizes.particle_bytes) / frames);
  if (h.max_foam > 0)
    std::printf(", %.0f for up to %lld of foam", static_cast<double>(sizes.foam_bytes) / frames,
                static_cast<long long>(h.max_foam));
  if (h.has_pictures()) {
    std::printf(" and %.0f for the picture", static_cast<double>(sizes.picture_bytes) / frames);
  }
  std::printf("; %.1f MB in all; bake %s\n", 1e-6 * static_cast<double>(sizes.file_bytes),
              bake.content_hash().c_str());
}

void bake(const BakeCommand& command) {
  const StopSignals signals;
  const study::BakeOrder order = order_of(command);
  const sim::BakeHeader header = study::header_of(order);
  if (!command.surface.empty() && !study::draws(header))
    throw base::Error(
        "--surface " + command.surface,
        "has no effect: the bake keeps particles alone, and " + header.method + " follows no picture",
        "add --pictures WIDTHxHEIGHT, or leave --surface out and draw the particles as you wish "
        "when they are shown");
  sim::BakeWriter::check_target(command.out, command.force);
  std::optional<sim::GlContext> context;
  if (study::draws(header)) context = sim::GlContext::make_headless();
  std::optional<base::Progress> settling, frames;
  study::BakeHooks hooks;
  hooks.stop = [&] {
    if (StopSignals::stop_requested())
      throw base::Error(command.out, "stopped on request; no file was written", "run the same command again");
  };
  hooks.settling = [&](int done, int total) {
    if (!settling) settling.emplace("settling", static_cast<std::size_t>(total));
    settling->update(static_cast<std::size_t>(done));
  };
  hooks.frames = [&](std::int64_t done) {
    if (!frames) frames.emplace("bake", static_cast<std::size_t>(command.frames));
    frames->update(static_cast<std::size_t>(done));
  };
  print_sizes(command.out, study::write_bake(order, header, command.out, command.force, hooks));
}

void bake_all(const BakeCommand& command) {
  const StopSignals signals;
  const std::string file = study::find_protocol(command.protocol).string();
  const study::Protocol protocol = study::read_protocol(file);
  ProtocolBakes request{file, command.out, {}, command.keep == "pictures"};
  request.look.size = *command.size;
  request.look.common.viewing =
      study::screen_viewing(command.screen_width_mm, command.viewing_distance_mm, protocol.true_angle);
  request.look.common.backend = command.backend;
  request.look.common.model = ptpe_model(command);
  study::check_visible(study::frame_scenes(protocol, request.look.common.viewing, request.look.size));
  bake_protocol(protocol, request, [&] {
    if (StopSignals::stop_requested())
      throw base::Error(command.out, "stopped on request; bakes that are complete stay, no other was written",
                        "run the same command again: it continues with the other bakes");
  });
}

void verify(const std::string& path) {
  const sim::BakeReader bake(path);
  const sim::BakeHeader& h = bake.header();
  const study::ReadingSpeed speed = study::read_whole(bake);
  std::printf("%s: %s, %s, n_* %lld, on %s, bake %s: all %lld frames are whole\n", path.c_str(),
              h.scene_name.c_str(), h.method.c_str(), static_cast<long long>(h.n_star), h.backend.c_str(),
              bake.content_hash().c_str(), static_cast<long long>(h.frame_count));
  std::printf("  %s%lld particles a frame read, checked and decoded at %.0f frames/s\n",
              h.radius_by_level_m.size() > 1 ? "up to " : "", static_cast<long long>(h.max_particles),
              speed.particles);
  if (h.max_foam > 0)
    std::printf("  with the foam of each, up to %lld particles\n", static_cast<long long>(h.max_foam));
  if (h.reference_k)
    std::printf("  with the temperature of each, off by at most %.2g K\n", speed.temperature_error_k);
  if (!h.has_pictures()) return;
  std::printf("  %dx%d pictures (%s%s%s) read, checked and decoded at %.0f frames/s\n", h.picture_width_px,
              h.picture_height_px, h.camera.c_str(),
              h.view.surface.empty() ? "" : (", of " + h.view.surface).c_str(),
              h.overlay.empty() ? "" : ", temperature painted", speed.pictures);
}

void add_scene_options(CLI::App& sub, BakeCommand& command) {
  for (CLI::Option* option :
       {add_method(sub, command.method), add_n_star(sub, command.n_star),
        add_count(sub, "--frames", command.frames, 1, 1 << 20, "Content steps to compute"),
        sub.add_option("--content-step", command.content_step_s,
                       "Fluid time between frames, s; default: the scene's")
            ->check(number_in(1e-6, 1)),
        sub.add_option("--pictures", command.pictures, "Keep pictures of this size too, such as 640x360"),
        sub.add_option("--camera", command.camera, "Camera of the pictures")
            ->check(CLI::IsMember({"view", "overview"}))
            ->capture_default_str(),
        sub.add_option("--overlay", command.overlay, "Painted over the water of the pictures")
            ->check(CLI::IsMember({"none", "temperature"}))
            ->capture_default_str()
            ->needs("--pictures"),
        sub.add_option(
               "--surface", command.surface,
               "How particles are drawn in the pictures, kept or followed by the method; the bake then "
               "records it. Default: ellipsoids, not recorded")
            ->check(CLI::IsMember({"ellipsoids", "spheres"})),
        sub.add_option("--rate", command.rate,
                       "Mean and standard deviation of the frame rate that tau of Ours-TSp follows from: "
                       "16.9,3.2"),
        static_cast<CLI::Option*>(
            sub.add_flag("--force", command.force, "Replace the output when it exists"))})
    option->group("A scene")->excludes("--protocol");
}

void add_protocol_options(CLI::App& sub, BakeCommand& command) {
  auto* size = add_size(sub, command.size, "Pixels of the participant's picture, as in run");
  auto* keep =
      sub.add_option(
             "--keep", command.keep,
             "particles: the session draws them. pictures: stores both, and the session shows the pictures")
          ->check(CLI::IsMember({"particles", "pictures"}))
          ->capture_default_str();
  const auto [width, distance] = add_viewing(sub, command.screen_width_mm, command.viewing_distance_mm,
                                             "Width of the participant's picture on the screen");
  for (CLI::Option* option : {size, keep, width, distance}) option->group("A protocol")->needs("--protocol");
}

}  // namespace

void add_bake_command(CLI::App& app) {
  auto command = std::make_shared<BakeCommand>();
  CLI::App& sub = *app.add_subcommand(
      "bake", "Compute the frames of a scene, or of a protocol's scenes, into files, or check one");
  auto* scene = sub.add_option("scene", command->scene, "Scene file");
  auto* out = sub.add_option("--out", command->out, "Bake file to write; with --protocol a folder");
  auto* protocol =
      sub.add_option("--protocol", command->protocol,
                     "Bake every stimulus of this protocol (file or name) that can be baked, into the folder "
                     "--out; run again, it continues and replaces unusable bakes");
  protocol->excludes(scene);
  add_scene_options(sub, *command);
  add_protocol_options(sub, *command);
  add_backend(sub, command->backend, "Computes the fluid");
  sub.add_option("--ptpe", command->ptpe,
                 "PTPE file from which tau of Ours-TSp follows; default: the paper's model");
  auto* check = sub.add_option("--verify", command->verify, "Read this bake and check every frame");
  check->excludes(scene)->excludes(out);
  sub.callback([command] {
    if (!command->verify.empty()) return verify(command->verify);
    const bool whole = !command->protocol.empty();
    if (!whole && command->scene.empty()) throw CLI::RequiredError("scene");
    if (command->out.empty()) throw CLI::RequiredError("--out");
    if (whole && !command->size) throw CLI::RequiredError("--size");
    whole ? bake_all(*command) : bake(*command);
  });
}

}  // namespace apps
