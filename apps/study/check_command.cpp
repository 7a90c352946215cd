/// vip-study check: how exactly a display shows the frame rates of a protocol, and whether this machine
/// computes its fluid in time; also prints the protocol's blocks, duration and balance.

#include <memory>
#include <string>

#include "apps/common/options.hpp"
#include "apps/study/check_report.hpp"
#include "apps/study/commands.hpp"
#include "apps/study/live_rates.hpp"
#include "libsim/methods/method.hpp"
#include "libsim/scene/extent.hpp"
#include "libsim/scene/scene.hpp"
#include "libstudy/pages/gui/page_fonts.hpp"
#include "libstudy/protocol/find_protocol.hpp"
#include "libstudy/runner/preview.hpp"
#include "libstudy/stimulus/bakes/cell_effects.hpp"
#include "libstudy/stimulus/headless_display.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/progress.hpp"

namespace apps {

namespace {

/// If all settings together have at most this many frames, the common refresh rates are checked even without
/// --compare.
constexpr std::int64_t most_compared = 8000;

struct CheckOptions {
  std::string protocol;
  double refresh_hz = 0;  ///< refresh rate of the display, Hz; 0: not given
  std::string json;
  bool compare = false;
  bool measure = false;
  std::string backend = "auto", preview;
  base::PictureSize size{1920, 1080};
  std::optional<double> screen_width_mm, viewing_distance_mm;
};

/// Checks scenes, methods, n_* and effects, which the reader of protocols does not check against libsim.
void check_stimuli(const study::Protocol& protocol, const std::string& file) {
  for (const auto& what : study::stimuli_of(protocol)) {
    try {
      sim::parse_method(what.method);
      const std::int64_t n_star = sim::parse_n_star(what.n_star);
      sim::check_ways(sim::read_scene(base::find_input(what.scene)), n_star);
    } catch (const base::Error& error) {
      throw base::Error(file + ": design", error.what(), "");
    }
  }
  study::check_cell_effects(protocol);
}

std::vector<study::RefreshCheck> check_common(const study::Protocol& protocol) {
  std::vector<study::RefreshCheck> checks;
  base::Progress progress("refresh rates", study::common_refreshes.size());
  for (const double refresh_hz : study::common_refreshes) {
    checks.push_back(study::check_refresh(protocol, refresh_hz));
    progress.update(checks.size());
  }
  return checks;
}

/// Measures all cells with their fluid computed live, on a headless display, without using cached times.
study::MeasuredReport measure_here(const CheckOptions& options, const CheckReport& report,
                                   const study::Viewing& viewing) {
  const study::Protocol& protocol = report.protocol;
  study::RunOptions choice;
  choice.display = "headless";
  choice.backend = options.backend;
  study::HeadlessDisplay display(options.size.width, options.size.height);
  study::CellStimuli stimuli(choice, protocol, {}, viewing);
  const auto all = [](int) { return true; };
  const double refresh_hz = report.refresh->refresh_hz;
  const auto live = measure_live(protocol, stimuli, {display, report.scenes, refresh_hz, {}, all});
  return study::judge_measured(protocol, live.stimuli, refresh_hz, [&](const study::FpsSetting& setting) {
    return study::intervals_on(*report.refresh, report.settings, setting);
  });
}

CheckReport make_report(const CheckOptions& options, const study::Protocol& protocol) {
  const study::Viewing viewing =
      study::screen_viewing(options.screen_width_mm, options.viewing_distance_mm, protocol.true_angle);
  CheckReport report{.protocol = protocol,
                     .outline = study::outline_session(protocol),
                     .balance = study::check_balance(protocol),
                     .settings = study::checked_settings(protocol),
                     .refresh = {},
                     .common = {},
                     .measured = {},
                     .scenes = study::frame_scenes(protocol, viewing, options.size)};
  if (options.refresh_hz > 0) report.refresh = study::check_refresh(protocol, options.refresh_hz);
  std::int64_t frames = 0;
  for (const auto& one : report.settings) frames += study::frame_count(one.setting);
  if (frames > 0 && (frames <= most_compared || options.compare)) report.common = check_common(protocol);
  if (options.measure) report.measured = measure_here(options, report, viewing);
  return report;
}

/// One copy of each scene for each level of effects, with the level in the scene's name.
std::vector<study::FramedScene> with_levels(const study::Protocol& protocol,
                                            const std::vector<study::FramedScene>& scenes) {
  if (protocol.design.effects.empty()) return scenes;
  std::vector<study::FramedScene> out;
  for (const study::FramedScene& scene : scenes) {
    for (const study::EffectSet& level : protocol.design.effects) {
      out.push_back(scene);
      out.back().scene = study::scene_with(scene.scene, study::effects_of(protocol, level.name, scene.scene));
      out.back().scene.name += ", effects " + level.name;
    }
  }
  return out;
}

void check_protocol(const CheckOptions& options) {
  if (options.measure && options.refresh_hz <= 0) {
    throw base::Error("--measure", "needs the refresh rate of the display, which limits the frame rates",
                      "add --refresh HZ");
  }
  const auto path = study::find_protocol(options.protocol);
  const auto protocol = study::read_protocol(path);
  check_stimuli(protocol, path.string());
  const CheckReport report = make_report(options, protocol);
  print_report(report);
  if (!options.preview.empty())
    study::write_preview(options.preview, with_levels(protocol, report.scenes),
                         protocol.design.paint_temperature);
  if (!options.json.empty()) base::write_file_atomically(options.json, report_json(report).dump(2) + "\n");
  if (report.measured && !report.measured->collapse.empty()) {
    throw base::Error(path.string() + ": timing = \"native\"",
                      "would compare equal stimuli on this machine: " + report.measured->collapse,
                      "use timing = \"table2\" or \"equal\", or larger n_*");
  }
  study::check_visible(report.scenes);
  study::check_pages(report.protocol);
}

}  // namespace

void add_check_command(CLI::App& app) {
  auto options = std::make_shared<CheckOptions>();
  auto* command =
      app.add_subcommand("check", "Check a protocol, and print its blocks, duration, balance and timing");
  command
      ->add_option("protocol", options->protocol,
                   "Protocol file, or the name of one that comes with the program, such as task1")
      ->required();
  command
      ->add_option("--refresh", options->refresh_hz,
                   "The display's refresh rate, Hz: prints how well it can show each setting")
      ->check(number_in(10, 1000));
  command->add_flag("--compare", options->compare, "Check all common refresh rates, however long it takes");
  command->add_flag("--measure", options->measure,
                    "Measure each live stimulus in a trial on this machine, at --size, as run does before a "
                    "session; run then need not repeat it");
  add_backend(*command, options->backend, "Computes the fluid");
  add_size(*command, options->size, "Pixels of the participant's picture");
  add_viewing(*command, options->screen_width_mm, options->viewing_distance_mm, "Its width on the screen");
  command
      ->add_option("--preview", options->preview,
                   "Folder for a page that shows each scene as the participant will see it")
      ->check(output_folder());
  command->add_option("--json", options->json, "File for every number of the report")->check(output_file());
  command->callback([options] { check_protocol(*options); });
}

}  // namespace apps
