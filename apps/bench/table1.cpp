/// vip-bench table1: the paper's Table 1 (image quality of the methods against HiRes), measured on this
/// machine.

#include <fmt/core.h>
#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "apps/bench/commands.hpp"
#include "apps/bench/table_options.hpp"
#include "apps/common/options.hpp"
#include "libsim/gl/gl_context.hpp"
#include "libsim/measure/cell_scores.hpp"
#include "libsim/measure/table1.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

/// The options, with the value of --checkpoints as typed.
struct Table1Words : measure::Table1Options {
  std::string checkpoints_word = "all";
};

int checkpoints_of(const std::string& word) {
  if (word == "all") return 0;
  const int count = base::parse_number<int>(word).value_or(0);
  if (count < 1)
    throw base::Error("--checkpoints " + word, "is not a number of checkpoints", "use all, 1, 2, ...");
  return count;
}

std::string started(const std::vector<measure::StartQuality>& starts, const std::string& what) {
  std::string out = "starts of " + what + " (most projections, largest compression, mean n / (8 n_*)):";
  for (const auto& start : starts) {
    out += fmt::format(" {} {}, {:.2f} %, {:.3f};", sim::method_name(start.method), start.worst.projections,
                       100 * start.worst.compression, start.particles_share);
  }
  out.back() = '\n';
  return out;
}

struct Table1 {
  std::vector<measure::ScoreBlock> blocks;
  std::string notes;
  std::string then_path;                         ///< file of an earlier run for comparison; empty = none
  std::optional<measure::CellScores> then = {};  ///< scores in the file `then_path`

  std::string text() const {
    const std::string change = then ? "now - " + then_path + ":\n\n" +
                                          figures::to_markdown(measure::change_rows(blocks, *then)) + "\n"
                                    : "";
    return figures::to_markdown(measure::score_table(blocks)) + "\n" +
           figures::to_markdown(measure::paired_rows(blocks)) + "\n" + change + notes;
  }
};

/// Path of a further table in the folder of `csv`: "rows_paired.csv" for "rows.csv" and the word "paired".
std::filesystem::path beside(const std::filesystem::path& csv, const std::string& word) {
  return csv.parent_path() / (csv.stem().string() + "_" + word + csv.extension().string());
}

void write_outputs(const measure::Table1Options& options, const Table1& table) {
  if (!options.csv.empty()) {
    base::write_file_atomically(options.csv, figures::to_csv(measure::score_rows(table.blocks)));
    base::write_file_atomically(beside(options.csv, "paired"),
                                figures::to_csv(measure::paired_rows(table.blocks)));
    if (table.then) {
      const figures::TextTable change = measure::change_rows(table.blocks, *table.then);
      base::write_file_atomically(beside(options.csv, "change"), figures::to_csv(change));
    }
  }
  if (!options.cells.empty())
    base::write_file_atomically(options.cells, figures::to_csv(measure::cell_rows(table.blocks)));
  if (!options.markdown.empty()) base::write_file_atomically(options.markdown, table.text());
  if (options.svg_folder.empty()) return;
  base::make_folder(options.svg_folder);
  for (const auto& metric : measure::all_metrics()) {
    const std::string chart = measure::score_chart(table.blocks, metric);
    const auto path =
        std::filesystem::path(options.svg_folder) / ("table1_" + std::string(metric.name) + ".svg");
    if (!chart.empty()) base::write_file_atomically(path, chart);
  }
}

/// All scenes, sizes and presets of the table. plan_of() checks them before the first run.
struct Plan {
  std::vector<sim::CellScene> scenes;
  std::vector<measure::CellSize> sizes;
  std::vector<sim::Preset> presets;
  std::vector<measure::ScoreBlock> blocks;  ///< the blocks of the table, still without scores
  std::size_t runs = 0;
};

Plan plan_of(const measure::Table1Options& options) {
  Plan out{sim::scenes_of(options.scene),
           measure::sizes_of(options.n_star),
           measure::presets_of(options.preset),
           {}};
  for (const auto& scene : out.scenes) {
    measure::gaze_points(scene.scene, 0, options.gazes);
    for (const auto& size : out.sizes) {
      measure::run_options(options, scene, size, out.presets.front(), sim::MethodKind::OursTsp);
      const auto starts = measure::stored_digests(scene, size, options);
      for (const auto preset : out.presets) {
        out.blocks.push_back(measure::empty_block(scene, size, preset, options));
        out.blocks.back().starts = starts;
      }
      out.runs += measure::still_runs(scene, options, out.presets.size());
    }
  }
  return out;
}

/// For each scene and size, writes the output files after the still pictures, and again after the runs that
/// compare the methods frame by frame (SSIM-cumul and flicker), so that an interrupted run has stored the
/// finished parts.
void run_table1(const measure::Table1Options& options) {
  check_apart("", {{"--csv", options.csv},
                   {"--markdown", options.markdown},
                   {"--cells", options.cells},
                   {"--paired-with", options.paired_with}});
  const Plan plan = plan_of(options);
  Table1 table{.blocks = {}, .notes = {}, .then_path = options.paired_with};
  if (!options.paired_with.empty()) {
    table.then = measure::read_cells(options.paired_with);
    measure::check_paired(plan.blocks, *table.then, options.paired_with);
  }
  auto context = sim::GlContext::make_headless();
  if (!options.pictures.empty()) base::make_folder(options.pictures);
  if (!options.checkpoints_to.empty()) base::make_folder(options.checkpoints_to);
  measure::SheetWriter sheets;
  base::Progress progress("still runs", plan.runs);
  std::size_t runs = 0;
  const auto done = [&] { progress.update(++runs); };
  for (const auto& scene : plan.scenes) {
    for (const auto& size : plan.sizes) {
      auto stills = measure::run_stills(scene, size, options, plan.presets, done, sheets);
      table.notes += started(stills.starts, scene.name + " " + size.word);
      const std::size_t first = table.blocks.size();
      table.blocks.insert(table.blocks.end(), stills.blocks.begin(), stills.blocks.end());
      write_outputs(options, table);
      if (options.cumul_frames == 0) continue;
      for (std::size_t b = first; b < table.blocks.size(); ++b)
        measure::run_film(scene, size, options, table.blocks[b]);
      write_outputs(options, table);
    }
  }
  sheets.finish();
  std::printf("%s", table.text().c_str());
}

}  // namespace

void add_table1_command(CLI::App& app) {
  auto words = std::make_shared<Table1Words>();
  auto* command =
      app.add_subcommand("table1", "The paper's Table 1: PSNR and SSIM of the methods against HiRes");
  add_table_options(*command, *words);
  command
      ->add_option("--checkpoints", words->checkpoints_word,
                   "all, or how many of the scene's, from the first")
      ->capture_default_str();
  add_count(*command, "--gazes", words->gazes, 1, 16, "Gaze points at a checkpoint");
  add_count(*command, "--repeats", words->repeats, 1, 1000, "Perturbed starts of each");
  add_count(*command, "--frames-after", words->frames_after, 1, 1000,
            "Frames from a checkpoint to its picture");
  add_count(*command, "--cumul-frames", words->cumul_frames, 0, 100000,
            "Frames of SSIM-cumul and flicker; 0 = neither");
  add_count(*command, "--film-starts", words->film_starts, 1, 100, "Starts of these frames, an ulp apart");
  add_count(*command, "--projections", words->projections, 1, 10000,
            "Density projections of a start, at most");
  command->add_flag("--unperturbed", words->unperturbed,
                    "Starts are not moved: HiRes must equal itself (a check of the bench)");
  add_size(*command, words->size, "Pictures, px");
  command
      ->add_option("--pictures", words->pictures,
                   "Folder for the methods side by side, painted by level below; made when missing")
      ->check(output_folder());
  auto* to = command
                 ->add_option("--checkpoints-to", words->checkpoints_to,
                              "Folder in which HiRes' checkpoints are stored; made when missing")
                 ->check(output_folder());
  auto* from =
      command
          ->add_option(
              "--checkpoints-from", words->checkpoints_from,
              "Folder of stored checkpoints, from which this run starts instead of running HiRes up to "
              "them")
          ->excludes(to);
  command->add_option("--cells", words->cells, "File for the scores of each picture, as CSV")
      ->check(output_file());
  command
      ->add_option("--paired-with", words->paired_with,
                   "Such a file of another run: adds what changed since, over pairs of checkpoint and gaze; "
                   "both runs start from the same stored checkpoints")
      ->needs(from);
  command->callback([words] {
    words->checkpoints = checkpoints_of(words->checkpoints_word);
    run_table1(*words);
  });
}

}  // namespace apps
