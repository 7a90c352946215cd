#pragma once
/// Choices between pairs of conditions, and ratings of them, for one scale of quality: from a database, or
/// from CSV files of any program.

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/plan_file.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "stats/preference/quality_scale.hpp"

namespace study {

/// A part of the answers that gets a scale of its own.
struct ScaleGroup {
  std::string name;  ///< the value of ScaleTable::by, such as "corridor"; empty: all answers
  std::vector<std::string> conditions;
  stats::ScaleData data;  ///< persons are indices into ScaleTable::people
};

struct ScaleTable {
  std::string by;  ///< the column or factor whose values part the answers; empty: one scale
  std::vector<std::string> people = {};  ///< codes; empty if people are not known
  bool people_known = true;
  std::vector<ScaleGroup> groups = {};
  std::vector<std::string> warnings = {};  ///< what makes the result weaker than it looks
  std::vector<std::string> notes = {};     ///< what was pooled or left out
  Json study = {};  ///< of a database: the entries "study" and "exclusions" of the results
  Json exclusions = {};
};

/// Collects answers by group, and sums equal answers of one person.
class ScaleCollector {
 public:
  void add_choice(const std::string& group, const std::string& person, const std::string& first,
                  const std::string& second, bool first_chosen, double count);
  void add_rating(const std::string& group, const std::string& person, const std::string& condition,
                  int score, double count);
  /// Moves the choices and ratings that were added into `table`. base::Error that names `place` if there are
  /// too many conditions or different scores.
  void finish(ScaleTable& table, const std::string& place);

 private:
  struct Part {
    std::string name;
    std::vector<std::string> conditions = {};
    std::map<std::string, int> numbers = {};                                    ///< of conditions
    std::map<std::tuple<int, int, int>, std::pair<double, double>> pairs = {};  ///< person, first, second
    std::map<std::tuple<int, int, int>, double> ratings = {};                   ///< person, condition, score
    std::set<int> scores = {};
  };
  Part& part_of(const std::string& name);

  std::vector<std::string> people_, groups_;
  std::map<std::string, int> person_numbers_, group_numbers_;
  std::vector<Part> parts_;
};

/// Reads choices, and ratings unless `ratings` is empty, from CSV files. The file of choices has the columns
/// "first" and "second" (names of the two conditions in the order in which they were shown) and "chosen"
/// ("first", "second" or a condition's name). The file of ratings has "condition" and "score" (a whole
/// number). Both may have "person" (equal texts are one person), "count" (how many equal answers a row stands
/// for; 1 if it is missing) and the column that `by` names. If a file lacks "person", the people are not
/// known, and the table gets a warning.
/// base::Error at file:line.
ScaleTable scale_table_of_csv(const std::filesystem::path& choices, const std::filesystem::path& ratings,
                              const std::string& by);

/// The choice of answers in a database.
struct ScaleSelection {
  std::string database;                     ///< for messages
  std::vector<std::string> protocols = {};  ///< texts for is_meant(); empty: all protocols
  std::vector<std::string> questions = {};  ///< ids; empty: the main questions
  std::string by = {};  ///< "scene", "method", "n_*", "frame rate", or a protocol's factor
  stats::ExclusionRules exclusions = {};
};

/// Collects the choices of protocols that show pairs and the ratings of protocols that show single stimuli. A
/// condition is named by what varies: method, n_*, frame rate (unless it follows from the others), or the
/// levels of a protocol's factors; scenes are pooled, which is a note. Participants with one code are one
/// person. base::Error if there is no choice or rating, or if several protocols or questions of one kind
/// match.
ScaleTable scale_table_of_study(const TaskStudy& study, const ScaleSelection& selection);

}  // namespace study
