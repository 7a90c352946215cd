#include <array>
#include <string_view>

#include "libstudy/observer/picture_features.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

struct Row {
  std::string_view method;
  PictureFeatures features;
};

// Estimates by particle size: the bumps are about as large as the particles where people look, and splits
// and merges make them pop.
constexpr std::array<Row, 5> rows{{{"LoRes", {16, 0.020}},
                                   {"FovFluid", {10, 0.024}},
                                   {"Ours", {9.2, 0.020}},
                                   {"Ours-TSp", {9.4, 0.021}},
                                   {"HiRes", {8, 0.016}}}};

}  // namespace

PictureFeatures FeatureTable::of(const StimulusSpec& stimulus) {
  for (const Row& row : rows) {
    if (row.method == stimulus.method) return row.features;
  }
  throw base::Error("method " + stimulus.method, "has no picture features beforehand",
                    "use --display headless, which measures them, or another observer");
}

}  // namespace study
