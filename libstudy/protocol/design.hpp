#pragma once
/// The design of a study: its stimuli, their order and their assignment to participants.

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/pacing/profile.hpp"
#include "libstudy/pacing/schedule.hpp"
#include "libstudy/protocol/procedure.hpp"

namespace study {

/// Names a stimulus in the words of the protocol. The parsers of libsim interpret these words.
struct StimulusSpec {
  std::string scene;         ///< path of the scene file
  std::string method;        ///< name of the method, such as "HiRes"
  std::string n_star;        ///< number of particles if all were at the coarsest level, such as "32k"
  std::string effects = {};  ///< level of effects: EffectSet::name; empty: the design does not vary effects
  /// How the particles are drawn: "ellipsoids" or "spheres"; empty: not named, which draws ellipsoids.
  std::string surface = {};

  bool operator==(const StimulusSpec&) const = default;
};

/// Name of the treatment compared within a group: "Ours", or "Ours, foam" if the design varies effects, or
/// "Ours, spheres" if it names surfaces.
std::string treatment_name(const StimulusSpec& what);

/// Levels of the factor effects that need no [[design.effect_set]]: no effects, and the effects of the scene
/// file.
inline constexpr const char* no_effects_level = "none";
inline constexpr const char* scene_effects_level = "scene";

/// A level of the factor effects: its name and its effects.
struct EffectSet {
  std::string name;
  /// Description for messages, such as "keeps foam; air_drag rate_per_s = 2" or "no effects". The effects
  /// themselves are read from the protocol's text (effects_of()).
  std::string words;
};

/// True if the design varies effects and the level of this stimulus is not "none".
inline bool has_effects(const StimulusSpec& what) {
  return !what.effects.empty() && what.effects != no_effects_level;
}

/// Source of the mean and standard deviation (moments) of each cell's frame rate.
enum class TimingSource {
  Settings,  ///< each mean_fps of the design with each smaller sd_fps, as in the pilot
  Native,    ///< as fast as the method runs: no schedule, and the moments in Cell::setting are 0
  Equal,     ///< the same mean and SD of the frame rate for all cells
  Table2,    ///< moments by cell from [[design.moments]], such as those of the paper's Table 2
  Profiles   ///< each cell's own timing profile (format 3)
};

/// An experimental factor of format 3. Format 2 has fixed factors instead: scene, n_*, method, effects and
/// moments.
struct DesignFactor {
  std::string name;  ///< an id
  /// True: between subjects, so that a participant sees one level only. False: within subjects, all levels.
  bool between = false;
  std::vector<std::string> levels;  ///< ids, in file order; at least two
};

/// A cell of the design: one stimulus at one setting of the frame rate.
struct Cell {
  StimulusSpec stimulus;
  FpsSetting setting;            ///< mean and standard deviation are 0 under TimingSource::Native
  std::vector<int> levels = {};  ///< by factor: index into DesignFactor::levels; empty in format 2
};

enum class TrialOrder {
  Shuffle,     ///< random; every permutation is equally likely
  Latin,       ///< rows of a Latin square in turn: each trial equally often at each position
  Williams,    ///< rows of a Williams design, which balances first-order carry-over
  Constrained  ///< shuffled until no neighbouring trials share a level of a factor in `never_adjacent`
};

enum class Assignment {
  /// groups and rows of the order's square (Latin, Williams) are assigned such that participants other than
  /// dropouts use all equally often
  Balanced,
  PaperRandom  ///< groups and orders are drawn at random for each participant, as in the paper
};

/// Cells are grouped by (scene, n_star), in format 3 by the levels of the between-subject factors, with
/// equally many cells in each group. A participant sees `groups` groups, one after another. In each group the
/// participant sees all cells, or all pairs of pairs_of_group(); with a procedure, the trials of its tracks.
struct Design {
  std::vector<Cell> cells;            ///< by group, in file order; trials name cells by their index
  std::vector<DesignFactor> factors;  ///< of format 3, in file order; empty in format 2
  std::vector<EffectSet> effects;     ///< levels in file order; empty: the design does not vary effects
  /// True: the water of every cell is painted by its temperature. Every cell then needs the effect heat.
  bool paint_temperature = false;
  TimingSource timing = TimingSource::Settings;
  bool pairs = false;  ///< true: each trial shows two cells of a group; see pairs_of_group()
  /// The standard of two-interval trials of format 3; `pairs` is then true. Every other cell of a group is
  /// paired with the standard that has its levels of the factors without a level here. By factor: index of
  /// the standard's level; none for a between-subject factor, and for a factor that the standard does not
  /// name.
  std::optional<std::vector<std::optional<int>>> standard;
  /// Adaptive trials of format 3; none: every cell, or pair, is shown `repetitions` times.
  std::optional<Procedure> procedure;
  int repetitions = 1;  ///< trials of each cell, or pair, in a session; more than 1 only in format 3
  /// Groups per participant, with different scenes, and different n_star as far as possible; 1 in format 3.
  int groups = 1;
  TrialOrder order = TrialOrder::Shuffle;
  /// Factors for TrialOrder::Constrained: "method", "effects", "mean_fps" or "sd_fps"; in format 3 their
  /// names.
  std::vector<std::string> never_adjacent;
  Assignment assignment = Assignment::Balanced;
};

/// For each group, in file order, the indices of its cells in Design::cells.
std::vector<std::vector<int>> cell_groups(const Design& design);

/// Number of trials of one group: the number of its cells, or of its pairs of cells, times the repetitions.
/// With a procedure: the trials of all tracks. All groups of a design have equally many trials.
int trials_of_group(const Design& design);

/// The pairs of cells of one group that two-interval trials show, in file order: all unordered pairs, or
/// every other cell with its standard.
std::vector<std::pair<int, int>> pairs_of_group(const Design& design, const std::vector<int>& group);

/// True if the cell has the level of every factor that Design::standard names. Requires Design::standard.
bool is_standard(const Design& design, const Cell& cell);

/// True if the surface (StimulusSpec::surface) is not that of the first cell in all cells.
bool varies_surface(const Design& design);

/// The level of a factor of format 3 as text, such as "h50".
const std::string& level_name(const Design& design, const Cell& cell, std::size_t factor);
/// Levels of all factors, such as "hitch h50, content dam"; in format 2 treatment_name().
std::string cell_name(const Design& design, const Cell& cell);
/// True if both cells share a level of one of the never_adjacent factors.
bool share_level(const Design& design, const Cell& a, const Cell& b);

}  // namespace study
