#pragma once
/// What is shown, in which combinations and how they are dealt out.

#include <string>
#include <vector>

#include "libstudy/pacing/schedule.hpp"

namespace study {

/// What is shown; libstudy only passes these words on.
struct StimulusSpec {
  std::string scene;         ///< scene file
  std::string method;        ///< "HiRes", ...
  std::string n_star;        ///< "32k"
  std::string effects = {};  ///< level of the factor effects: EffectSet::name; empty: they are no factor

  bool operator==(const StimulusSpec&) const = default;
};

/// What is compared within a group, in words: "Ours", or where effects are a factor "Ours, foam".
std::string treatment_name(const StimulusSpec& what);

/// Levels of the factor effects that need no table: no effect at all, and those of the scene's file.
inline constexpr const char* no_effects_level = "none";
inline constexpr const char* scene_effects_level = "scene";

/// A level of the factor effects.
struct EffectSet {
  std::string name;
  /// What it holds: "keeps foam; air_drag rate_per_s = 2"; "no effects"; "those of the scene's file". Kinds
  /// and numbers are libsim's, which reads them from the protocol's text.
  std::string words;
};

/// Whether effects are a factor and this level of them holds some.
inline bool has_effects(const StimulusSpec& what) {
  return !what.effects.empty() && what.effects != no_effects_level;
}

/// Where the moments of the frame rate come from.
enum class TimingSource {
  Settings,  ///< mean_fps and sd_fps of the design (pilot)
  Native,    ///< as fast as the method runs: no schedule, the setting's moments are 0
  Equal,     ///< one mean and deviation for all cells
  Table2     ///< each cell's own, as published (paper, Table 2), also fed to tau
};

/// One combination of the factors.
struct Cell {
  StimulusSpec stimulus;
  FpsSetting setting;  ///< moments 0 under TimingSource::Native
};

enum class TrialOrder {
  Shuffle,     ///< every permutation equally likely
  Latin,       ///< rows of a Latin square, dealt in turn: each trial equally often at each place
  Williams,    ///< rows of a Williams design: first-order carry-over balanced
  Constrained  ///< shuffled until no neighbours share a level of `never_adjacent`
};

enum class Assignment {
  Balanced,    ///< groups and rows are dealt by quota over all who took part and did not drop out
  PaperRandom  ///< independent draws, as the paper did
};

/// Cells fall into groups of equal (scene, n_star), equally many in each; a participant meets `groups` of
/// them, one after another, and within each all its cells, or all pairs of its cells.
struct Design {
  std::vector<Cell> cells;         ///< grouped, in file order; a trial names one or two by index
  std::vector<EffectSet> effects;  ///< levels in file order; empty: effects are no factor
  bool paint_temperature = false;  ///< over the water of every cell; that each has any is libsim's to say
  TimingSource timing = TimingSource::Settings;
  bool pairs = false;  ///< a trial shows two cells; all unordered pairs of a group
  int groups = 1;      ///< that a participant meets: different scenes, and different n_star while there are
  TrialOrder order = TrialOrder::Shuffle;
  std::vector<std::string> never_adjacent;  ///< "method", "effects", "mean_fps" or "sd_fps"; Constrained
  Assignment assignment = Assignment::Balanced;
};

/// The cells of each group, as indices, in file order.
std::vector<std::vector<int>> cell_groups(const Design& design);

/// Trials that one group makes: its cells, or its pairs of cells. A file's groups all have equally many.
int trials_of_group(const Design& design);

}  // namespace study
