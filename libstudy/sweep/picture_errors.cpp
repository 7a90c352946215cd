#include "libstudy/sweep/picture_errors.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "libsim/gl/png.hpp"
#include "stats/base/error.hpp"
#include "stats/base/timing.hpp"
#include "stats/image/flicker.hpp"
#include "stats/image/flip.hpp"
#include "stats/image/psnr.hpp"
#include "stats/image/ssim.hpp"

namespace study {

namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t fewest_mask_pixels = 100;
constexpr double parting_share = 1.0 / 3;

[[noreturn]] void refuse_pictures() {
  throw base::Error("the sweep",
                    "has pictures that are damaged, or that differ from the reference's in time or size",
                    "run the sweep again into a new file");
}

using Mask = std::vector<std::uint8_t>;

sim::Picture decoded(const KeptPicture& kept) {
  return sim::without_alpha(sim::png_of(kept.png, "a picture of the sweep"));
}

/// True for the first picture of a pair (1/30 s apart). Errors of single pictures use the first picture. The
/// error of the change within 1/30 s uses both pictures of the pair.
bool first_of_pair(std::size_t i) { return i % 2 == 0; }

/// The reference run with decoded pictures and masks.
struct Reference {
  std::vector<double> times_s = {};
  std::vector<sim::Picture> pictures = {};
  std::vector<Mask> fovea = {}, salient = {};  ///< for each picture; empty without a mask of enough pixels
  double pixels_per_degree = 0;
};

Mask large_enough(Mask mask) {
  const auto pixels = std::count(mask.begin(), mask.end(), 1);
  return static_cast<std::size_t>(pixels) < fewest_mask_pixels ? Mask{} : std::move(mask);
}

Reference reference_of(const CellRun& run) {
  Reference out{.pixels_per_degree = run.pixels_per_degree};
  for (const auto& kept : run.pictures) {
    out.times_s.push_back(kept.time_s);
    out.pictures.push_back(decoded(kept));
    const std::size_t pixels = out.pictures.back().view().pixels();
    out.fovea.push_back(large_enough(from_bits(kept.fovea, pixels)));
    out.salient.push_back(large_enough(from_bits(kept.salient, pixels)));
  }
  return out;
}

class Mean {
 public:
  void add(double value) {
    if (std::isnan(value)) return;
    sum_ += value;
    ++count_;
  }
  double value() const { return count_ ? sum_ / count_ : unknown; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

double rms_pct(const Mean& squares) { return 100 * std::sqrt(squares.value()) / 255; }

/// Differences of one run from the reference for each stored picture. `square`, `fovea`, `salient`: mean
/// squared difference over the whole picture and over the two masks. `structure`: 1 - SSIM. `change`: mean
/// squared difference of the two runs' changes within the pair. `fovea`, `salient` and `structure` are NaN
/// for the second picture of a pair, `change` for the first; `fovea` and `salient` also without such a mask.
struct Trace {
  std::vector<double> square = {}, fovea = {}, salient = {}, structure = {}, change = {};
};

Trace trace_of(const CellRun& run, const Reference& reference) {
  if (run.pictures.size() != reference.pictures.size()) refuse_pictures();
  Trace out;
  sim::Picture before;
  for (std::size_t i = 0; i < run.pictures.size(); ++i) {
    sim::Picture now = decoded(run.pictures[i]);
    const sim::Picture& then = reference.pictures[i];
    if (std::abs(run.pictures[i].time_s - reference.times_s[i]) > 1e-9 || now.width != then.width ||
        now.height != then.height)
      refuse_pictures();
    const auto square = [&](const Mask& mask) {
      return stats::mean_squared_error(now.view(), then.view(), mask).value;
    };
    const bool first = first_of_pair(i);
    out.square.push_back(square({}));
    out.fovea.push_back(first && !reference.fovea[i].empty() ? square(reference.fovea[i]) : unknown);
    out.salient.push_back(first && !reference.salient[i].empty() ? square(reference.salient[i]) : unknown);
    out.structure.push_back(first ? 1 - stats::ssim_map(now.view(), then.view()).mean().value : unknown);
    out.change.push_back(
        first ? unknown
              : stats::flicker({before.view(), now.view()}, {reference.pictures[i - 1].view(), then.view()})
                    .value);
    before = std::move(now);
  }
  return out;
}

/// Calls `job(i)` for each i below `count` on all cores. Rethrows the first exception when all calls are
/// done.
template <class Job>
void for_all(std::size_t count, const Job& job) {
  std::exception_ptr problem;
#pragma omp parallel for schedule(dynamic)
  for (std::size_t i = 0; i < count; ++i) {
    try {
      job(i);
    } catch (...) {
#pragma omp critical(picture_errors)
      if (!problem) problem = std::current_exception();
    }
  }
  if (problem) std::rethrow_exception(problem);
}

double parting_of(const Reference& reference, const Trace& twin, const std::vector<Trace>& runs) {
  for (std::size_t i = 0; i < twin.square.size(); ++i) {
    std::vector<double> others;
    for (const auto& run : runs) others.push_back(run.square[i]);
    const double usual = std::sqrt(base::quantile(others, 0.5));
    if (twin.square[i] > 0 && std::sqrt(twin.square[i]) >= parting_share * usual) return reference.times_s[i];
  }
  return std::numeric_limits<double>::infinity();
}

PictureErrors errors_of(const CellRun& run, const Trace& trace, const Reference& reference,
                        double parting_s) {
  Mean all, fovea, salient, structure, flip, film, flicker;
  for (std::size_t i = 0; i < run.pictures.size(); ++i) {
    film.add(trace.structure[i]);
    flicker.add(trace.change[i]);
    if (!first_of_pair(i) || reference.times_s[i] >= parting_s) continue;
    all.add(trace.square[i]);
    fovea.add(trace.fovea[i]);
    salient.add(trace.salient[i]);
    structure.add(trace.structure[i]);
    flip.add(stats::flip(decoded(run.pictures[i]).view(), reference.pictures[i].view(),
                         reference.pixels_per_degree)
                 .value);
  }
  return {rms_pct(all),       rms_pct(fovea),     rms_pct(salient), 100 * structure.value(),
          100 * flip.value(), 100 * film.value(), rms_pct(flicker)};
}

}  // namespace

PictureScores score_pictures(const std::vector<const CellRun*>& runs, const CellRun& reference_run,
                             const CellRun& twin) {
  PictureErrors none;
  none.fill(unknown);
  PictureScores out{unknown, std::vector<PictureErrors>(runs.size(), none)};
  if (reference_run.pictures.empty() || runs.empty()) return out;
  const Reference reference = reference_of(reference_run);
  std::vector<Trace> traces(runs.size());
  for_all(runs.size(), [&](std::size_t i) { traces[i] = trace_of(*runs[i], reference); });
  out.parting_s = parting_of(reference, trace_of(twin, reference), traces);
  for_all(runs.size(),
          [&](std::size_t i) { out.errors[i] = errors_of(*runs[i], traces[i], reference, out.parting_s); });
  return out;
}

}  // namespace study
