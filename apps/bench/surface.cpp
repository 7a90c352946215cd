/// vip-bench surface: errors of the drawn surface, change of the picture where levels change, and
/// milliseconds of the renderer.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>

#include "apps/bench/commands.hpp"
#include "apps/common/options.hpp"
#include "libsim/gl/gl_context.hpp"
#include "libsim/measure/known_shapes.hpp"
#include "libsim/measure/surface_runs.hpp"
#include "libsim/setting/named_scenes.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/figures/text_table.hpp"

namespace apps {

namespace {

struct SurfaceOptions {
  std::string surface = "both";
  std::string n_star = "2k", backend = "auto";
  std::string csv, json, pictures;
  int warm_up = 24, frames = 60, timed_frames = 10;
  base::PictureSize size{640, 360};
};

/// One figure of each surface.
struct SurfaceRow {
  std::string figure, of, level;
  int digits;
  std::vector<double> values;  ///< NaN: the subject has no such figure
};

std::vector<sim::Surface> surfaces_of(const std::string& word) {
  if (word == "both") return {sim::Surface::Spheres, sim::Surface::Ellipsoids};
  return {sim::parse_surface(word)};
}

std::string level_word(int level) { return level == measure::mixed_levels ? "mixed" : std::to_string(level); }

void add_shape_rows(const SurfaceOptions& options, const std::vector<sim::Surface>& surfaces,
                    std::vector<SurfaceRow>& rows) {
  if (!options.pictures.empty()) base::make_folder(options.pictures);
  const std::int64_t n_star = sim::parse_n_star(options.n_star);
  for (const measure::KnownShape shape : measure::known_shapes) {
    for (int level = 0; level <= measure::mixed_levels; ++level) {
      const std::string of = measure::shape_name(shape), word = level_word(level);
      SurfaceRow outline{"outline_d", of, word, 3, {}}, normals{"normals_deg", of, word, 2, {}},
          scallop{"scallop", of, word, 4, {}};
      for (const sim::Surface surface : surfaces) {
        const measure::ShapePicture drawn = measure::draw_shape(shape, level, n_star, surface);
        outline.values.push_back(drawn.errors.outline_d);
        normals.values.push_back(drawn.errors.normals_deg);
        scallop.values.push_back(drawn.errors.scallop);
        if (!options.pictures.empty())
          sim::write_png(options.pictures + "/" + of + "_" + word + "_" + sim::surface_name(surface) + ".png",
                         drawn.image);
      }
      for (const SurfaceRow& row : {outline, normals, scallop})
        if (!std::isnan(row.values.front())) rows.push_back(row);
    }
  }
}

sim::SimulationOptions ours(const SurfaceOptions& options) {
  sim::SimulationOptions out;
  out.method = sim::MethodKind::Ours;
  out.n_star = sim::parse_n_star(options.n_star);
  out.backend = sim::choose_backend(options.backend);
  return out;
}

/// Faucet with its nozzle closed: water at rest.
sim::Scene still_pool() {
  sim::Scene out = sim::read_scene(base::find_input("data/scenes/faucet.toml"));
  out.name = "still pool";
  out.nozzles.clear();
  return out;
}

void add_run_rows(const SurfaceOptions& options, const std::vector<sim::Surface>& surfaces,
                  std::vector<SurfaceRow>& rows) {
  const sim::Scene dam = sim::read_scene(base::find_input("data/scenes/single_dam.toml"));
  for (const sim::Scene& scene : {dam, still_pool()}) {
    const auto popping = measure::measure_popping(scene, ours(options), options.warm_up, options.frames,
                                                  options.size, surfaces);
    SurfaceRow ratio{"popping", scene.name, "Ours", 2, {}},
        change{"change_between", scene.name, "Ours", 3, {}};
    for (const measure::Popping& one : popping) {
      ratio.values.push_back(one.ratio());
      change.values.push_back(one.other);
    }
    rows.push_back(ratio);
    rows.push_back(change);
  }
  for (const int views : {1, 2}) {
    const auto times =
        measure::measure_draw_times(dam, ours(options), options.timed_frames, options.size, views, surfaces);
    SurfaceRow take{"take_ms", dam.name, std::to_string(views), 3, {}},
        draw{"draw_ms", dam.name, std::to_string(views), 3, {}};
    for (const measure::DrawTimes& one : times) {
      take.values.push_back(one.take);
      draw.values.push_back(one.draw);
    }
    rows.push_back(take);
    rows.push_back(draw);
  }
}

figures::TextTable table_of(const std::vector<SurfaceRow>& rows, const std::vector<sim::Surface>& surfaces) {
  figures::TextTable out{{"figure", "of", "level"}, {}};
  for (const sim::Surface surface : surfaces) out.head.emplace_back(sim::surface_name(surface));
  if (surfaces.size() == 2) out.head.emplace_back("ratio");
  for (const SurfaceRow& row : rows) {
    auto& cells = out.rows.emplace_back(std::vector<std::string>{row.figure, row.of, row.level});
    for (const double value : row.values) cells.push_back(figures::number(value, row.digits));
    if (surfaces.size() == 2) cells.push_back(figures::number(row.values[1] / row.values[0], 3));
  }
  return out;
}

base::Json json_of(const std::vector<SurfaceRow>& rows, const std::vector<sim::Surface>& surfaces,
                   const SurfaceOptions& options) {
  base::Json all = base::Json::array();
  for (const SurfaceRow& row : rows) {
    base::Json one{{"figure", row.figure}, {"of", row.of}, {"level", row.level}};
    for (std::size_t k = 0; k < surfaces.size(); ++k) one[sim::surface_name(surfaces[k])] = row.values[k];
    all.push_back(one);
  }
  return {{"n_star", options.n_star},
          {"frames", options.frames},
          {"warm_up", options.warm_up},
          {"width_px", options.size.width},
          {"height_px", options.size.height},
          {"opengl", sim::gl_description()},
          {"rows", all}};
}

void run_surface(const SurfaceOptions& options) {
  check_apart("", {{"--csv", options.csv}, {"--json", options.json}});
  const auto surfaces = surfaces_of(options.surface);
  const auto context = sim::GlContext::make_headless();
  std::vector<SurfaceRow> rows;
  add_shape_rows(options, surfaces, rows);
  if (options.frames > 0) add_run_rows(options, surfaces, rows);
  const figures::TextTable table = table_of(rows, surfaces);
  std::printf("%s", figures::to_markdown(table).c_str());
  if (!options.csv.empty()) base::write_file_atomically(options.csv, figures::to_csv(table));
  if (!options.json.empty())
    base::write_file_atomically(options.json, json_of(rows, surfaces, options).dump(2) + "\n");
}

/// Refuses the options of the runs beside --frames 0, which leaves the runs out.
void refuse_beside_shapes_only(const CLI::App& command) {
  for (const char* option : {"--backend", "--warm-up", "--timed-frames", "--size"})
    if (command.get_option(option)->count() > 0) throw CLI::ExcludesError("--frames 0", option);
}

constexpr const char* surface_rows_help =
    "Shapes have n_* coarsest particles' volume. Their particles lie in layers parallel to the surface, "
    "with\n"
    "the solver's spacing d, each moved at random by up to d/10; mixed: four slabs side by side, of the\n"
    "levels 0 to 3; d is then the cube root of the mean volume.\n"
    "outline_d: RMS distance of the outline from the closed form over d; of the pool, RMS height over d.\n"
    "normals_deg: RMS angle to the true normals; of ball and column within 80 % of the radius.\n"
    "scallop: mean square of the outline's curvature times d, over wavelengths from 2/3 d to 3/2 d.\n"
    "popping: mean change of the picture in frames in which particles split or merged, over that in the\n"
    "others, change_between: of 255; both surfaces draw the same states. The still pool is Faucet with its\n"
    "nozzle closed. take_ms: the particles' way to OpenGL, with their ellipsoids; draw_ms: the picture; "
    "both\n"
    "are medians, and level is the number of eyes.";

}  // namespace

void add_surface_command(CLI::App& app) {
  auto options = std::make_shared<SurfaceOptions>();
  auto* command = app.add_subcommand("surface", "Errors, popping and time of the drawn surface");
  command->footer(surface_rows_help);
  command->add_option("--surface", options->surface, "ellipsoids, spheres or both")
      ->check(CLI::IsMember({"ellipsoids", "spheres", "both"}))
      ->capture_default_str();
  add_n_star(*command, options->n_star);
  add_backend(*command, options->backend);
  add_count(*command, "--frames", options->frames, 0, 100000,
            "Frames of popping; 0 = shapes only, without --backend, --warm-up, --timed-frames and --size");
  add_count(*command, "--warm-up", options->warm_up, 0, 10000, "Frames before them that do not count");
  add_count(*command, "--timed-frames", options->timed_frames, 1, 100000, "Frames of the times");
  add_size(*command, options->size, "Picture of one eye in the runs, px");
  command->add_option("--pictures", options->pictures, "Folder for the shapes' pictures; made when missing")
      ->check(output_folder());
  command->add_option("--csv", options->csv, "File for the table")->check(output_file());
  command->add_option("--json", options->json, "File for the figures")->check(output_file());
  command->callback([options, command] {
    if (options->frames == 0) refuse_beside_shapes_only(*command);
    run_surface(*options);
  });
}

}  // namespace apps
