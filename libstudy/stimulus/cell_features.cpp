#include "libstudy/stimulus/cell_features.hpp"

#include <cmath>
#include <set>

#include "libsim/gl/offscreen.hpp"
#include "libstudy/observer/picture_measure.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

constexpr int width_px = 640, height_px = 360;
constexpr std::int64_t steps = 240, between = 30;

MeasuredPicture to_measure(const sim::Image& image, const std::vector<float>& depth) {
  MeasuredPicture out{image.width, image.height, {}, {}};
  const std::size_t pixels = image.rgba.size() / 4;
  out.luminance.resize(pixels);
  out.fluid.resize(pixels);
  const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x) {
      // Rec. 709 weights applied to the gamma-coded values, because this measures visible detail and not
      // physical luminance.
      const std::uint8_t* c = &image.rgba[4 * (y * width + x)];
      out.luminance[y * width + x] = (0.2126F * c[0] + 0.7152F * c[1] + 0.0722F * c[2]) / 255;
      // The image starts with its top row, the depth with its bottom row.
      out.fluid[y * width + x] = std::isfinite(depth[(height - 1 - y) * width + x]);
    }
  }
  return out;
}

/// Mean position of the fluid's pixels.
std::pair<double, double> middle_of(const MeasuredPicture& picture) {
  double x_sum = 0, y_sum = 0, count = 0;
  for (std::size_t i = 0; i < picture.fluid.size(); ++i) {
    if (!picture.fluid[i]) continue;
    x_sum += static_cast<double>(i % static_cast<std::size_t>(picture.width));
    y_sum += static_cast<double>(i / static_cast<std::size_t>(picture.width));
    ++count;
  }
  return {x_sum / std::max(count, 1.0), y_sum / std::max(count, 1.0)};
}

/// Runs a cell and averages its measured features. base::Error if it shows no fluid at any measured step.
PictureFeatures run_cell(LiveFluid& fluid, std::int64_t start_frame) {
  const sim::Offscreen target(width_px, height_px);
  PictureFeatures sum;
  int count = 0;
  std::array<MeasuredPicture, 3> last;
  fluid.start(start_frame);
  for (std::int64_t step = 0; step <= steps + 1; ++step) {
    fluid.prepare(start_frame + step);
    const std::int64_t phase = (step + 1) % between;  // 0, 1, 2: the three successive pictures
    const bool measured = step + 1 >= between && phase <= 2;
    // The first step is drawn for methods that use the last picture.
    if (measured || step == 0 || fluid.needs_every_picture())
      fluid.draw({target.framebuffer(), width_px, height_px});
    if (!measured) continue;
    last[static_cast<std::size_t>(phase)] = to_measure(target.read(), fluid.read_depth());
    if (phase < 2) continue;
    const auto [x, y] = middle_of(last[1]);
    const auto found = measure_pictures(last, x, y);
    if (found.granularity_px == 0) continue;
    sum.granularity_px += found.granularity_px;
    sum.flicker += found.flicker;
    ++count;
  }
  if (count == 0)
    throw base::Error(fluid.description(), "shows no fluid to measure", "check the scene with vip-view");
  return {sum.granularity_px / count, sum.flicker / count};
}

std::string to_json(const std::string& key, const PictureFeatures& features) {
  return base::Json{{"key", key}, {"granularity_px", features.granularity_px}, {"flicker", features.flicker}}
             .dump(2) +
         "\n";
}

/// The features cached in a file; none if the file is missing, damaged or has another key.
std::optional<PictureFeatures> read_features(const std::filesystem::path& path, const std::string& key) {
  if (!std::filesystem::exists(path)) return {};
  const auto json = base::parse_json(base::read_file(path, 1 << 16));
  const auto of = [&](const char* name) { return json.contains(name) ? json[name] : base::Json(); };
  if (of("key") != key || !of("granularity_px").is_number() || !of("flicker").is_number()) return {};
  const PictureFeatures found{of("granularity_px"), of("flicker")};
  if (found.granularity_px <= 0 || found.flicker <= 0) return {};
  return found;
}

}  // namespace

std::string stimulus_words(const StimulusSpec& stimulus) {
  return stimulus.scene + ", " + stimulus.method + ", " + stimulus.n_star +
         (stimulus.effects.empty() ? "" : ", effects " + stimulus.effects) +
         (stimulus.surface.empty() ? "" : ", " + stimulus.surface);
}

PictureFeatures CellFeatures::read_or_measure(const Cell& cell, std::int64_t start_frame) const {
  const StimulusChoice choice = choice_of_(cell);
  const auto fluid = make_live_fluid(choice);
  std::string key = fluid->description() + "; from step " + std::to_string(start_frame) + " by " +
                    base::shortest(choice.content_step_s) + " s";
  if (const auto& rate = choice.fixed_rate)
    key += "; tau " + base::shortest(stats::ptpe_tolerance(choice.model, rate->mean, rate->sd));
  key += "; version " + base::version();
  const auto path = folder_ / ("features-" + base::sha256_hex(key).substr(0, 32) + ".json");
  if (const auto found = read_features(path, key)) return *found;
  const auto features = run_cell(*fluid, start_frame);
  base::make_folder(folder_);
  base::write_file_atomically(path, to_json(key, features));
  return features;
}

void CellFeatures::measure(const Protocol& protocol) {
  std::size_t done = 0;
  base::Progress progress("cells measured", protocol.design.cells.size());
  for (const Cell& cell : protocol.design.cells) {
    const std::string words = stimulus_words(cell.stimulus);
    if (!known_.count(words)) known_[words] = read_or_measure(cell, protocol.content.start_frame);
    progress.update(++done);
  }
}

PictureFeatures CellFeatures::of(const StimulusSpec& stimulus) {
  const auto found = known_.find(stimulus_words(stimulus));
  if (found == known_.end())
    throw base::Error(stimulus_words(stimulus), "was not measured",
                      "call CellFeatures::measure() with its protocol first");
  return found->second;
}

}  // namespace study
