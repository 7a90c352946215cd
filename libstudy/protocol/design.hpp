#pragma once
/// The stimuli of a study, their combinations and their assignment to participants.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/pacing/profile.hpp"
#include "libstudy/pacing/schedule.hpp"

namespace study {

/// Names a stimulus; libstudy does not interpret these words.
struct StimulusSpec {
  std::string scene;         ///< scene file
  std::string method;        ///< "HiRes", ...
  std::string n_star;        ///< "32k"
  std::string effects = {};  ///< level of the factor effects: EffectSet::name; empty: not a factor

  bool operator==(const StimulusSpec&) const = default;
};

/// Name of the treatment compared within a group: "Ours", or "Ours, foam" if effects are a factor.
std::string treatment_name(const StimulusSpec& what);

/// Levels of the factor effects without a table: no effect at all, and the effects of the scene file.
inline constexpr const char* no_effects_level = "none";
inline constexpr const char* scene_effects_level = "scene";

/// A level of the factor effects.
struct EffectSet {
  std::string name;
  /// Description: "keeps foam; air_drag rate_per_s = 2"; "no effects"; "those of the scene's file". libsim
  /// reads kinds and numbers from the protocol's text.
  std::string words;
};

/// True if effects are a factor and this level is not "none".
inline bool has_effects(const StimulusSpec& what) {
  return !what.effects.empty() && what.effects != no_effects_level;
}

/// Source of the moments of the frame rate.
enum class TimingSource {
  Settings,  ///< mean_fps and sd_fps of the design (pilot)
  Native,    ///< as fast as the method runs: no schedule, the setting's moments are 0
  Equal,     ///< the same mean and SD of the frame rate for all cells
  Table2,    ///< each cell's published moments (paper, Table 2), also used for tau
  Profiles   ///< each cell's own timing profile (format 3)
};

/// An experimental factor of format 3. Formats 1 and 2 have fixed factors instead: scene, n_*, method,
/// effects and moments.
struct DesignFactor {
  std::string name;  ///< an id
  /// True: between subjects, so that a participant sees one level only. False: within subjects, all levels.
  bool between = false;
  std::vector<std::string> levels;  ///< ids, in file order; at least two
};

/// One combination of the factors.
struct Cell {
  StimulusSpec stimulus;
  FpsSetting setting;            ///< moments 0 under TimingSource::Native
  std::vector<int> levels = {};  ///< by factor: index into DesignFactor::levels; empty in formats 1 and 2
};

enum class TrialOrder {
  Shuffle,     ///< every permutation equally likely
  Latin,       ///< rows of a Latin square, dealt in turn: each trial equally often at each position
  Williams,    ///< rows of a Williams design: first-order carry-over balanced
  Constrained  ///< shuffled until no neighbours share a level of `never_adjacent`
};

enum class Assignment {
  Balanced,    ///< groups and rows are dealt by quota over all participants but dropouts
  PaperRandom  ///< independent draws, as the paper did
};

/// Cells are grouped by (scene, n_star), in format 3 by the levels of the between-subject factors, with
/// equally many in each group. A participant sees `groups` groups, one after another, and within each all its
/// cells or all pairs of its cells.
struct Design {
  std::vector<Cell> cells;            ///< grouped, in file order; a trial names one or two by index
  std::vector<DesignFactor> factors;  ///< of format 3, in file order; empty in formats 1 and 2
  std::vector<EffectSet> effects;     ///< levels in file order; empty: not a factor
  bool paint_temperature = false;  ///< on the water of every cell; libsim checks that each has a temperature
  TimingSource timing = TimingSource::Settings;
  bool pairs = false;  ///< a trial shows two cells; all unordered pairs of a group
  /// Two-interval trials of format 3: each other cell is paired with the standard of its group. `pairs` is
  /// true then. By within-subject factor: index of the standard's level.
  std::optional<std::vector<int>> standard;
  int repetitions = 1;  ///< trials of each cell, or pair, in a session; more than 1 only in format 3
  int groups = 1;       ///< per participant: different scenes, and different n_star as far as possible
  TrialOrder order = TrialOrder::Shuffle;
  /// Constrained: "method", "effects", "mean_fps" or "sd_fps"; in format 3 names of factors.
  std::vector<std::string> never_adjacent;
  Assignment assignment = Assignment::Balanced;
};

/// The cells of each group, as indices, in file order.
std::vector<std::vector<int>> cell_groups(const Design& design);

/// Number of trials of one group: its cells, or its pairs of cells, times the repetitions. Equal for all
/// groups of a file.
int trials_of_group(const Design& design);

/// The pairs of cells of one group that two-interval trials show, in file order: all unordered pairs, or
/// every other cell with the standard.
std::vector<std::pair<int, int>> pairs_of_group(const Design& design, const std::vector<int>& group);

/// The level of a factor of format 3 as text, such as "h50".
const std::string& level_name(const Design& design, const Cell& cell, std::size_t factor);
/// Levels of all factors, such as "hitch h50, content dam"; in formats 1 and 2 treatment_name().
std::string cell_name(const Design& design, const Cell& cell);
/// True if both cells share a level of one of the never_adjacent factors.
bool share_level(const Design& design, const Cell& a, const Cell& b);

}  // namespace study
