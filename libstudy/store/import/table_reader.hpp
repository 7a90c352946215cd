#pragma once
/// Reads one table of another program, by a mapping, into the visits of people.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/import/cell_match.hpp"
#include "libstudy/store/import/mapping.hpp"
#include "libstudy/store/import/read_import.hpp"
#include "libstudy/store/import/source_table.hpp"
#include "libstudy/store/imported.hpp"

namespace study {

/// A trial with the row where it begins, "file:line".
struct PlacedTrial {
  ImportedTrial trial;
  std::string place;
};

/// A visit under way. `session` gets its trials at the end.
struct Visit {
  ImportedSession session;
  std::map<double, PlacedTrial> trials;  ///< by their numbers in the table
  std::filesystem::path file;
};

/// Visits by participant code and number.
using Visits = std::map<std::pair<std::string, int>, Visit>;

class TableReader {
 public:
  /// asked: the scored questions of the protocol's trials. base::Error if the table lacks a column of the
  /// mapping.
  TableReader(const Protocol& protocol, const ImportMapping& mapping,
              const std::vector<const Question*>& asked, const SourceTable& table, Visits& visits);

  /// Adds the table's trials to the visits. base::Error at file:line as read_import().
  ReadSource read();

 private:
  /// Conditions on rows, with the places of their columns.
  using Conditions = std::vector<std::pair<std::size_t, const RowCondition*>>;
  /// An [[answer]] of the mapping, with the places of its columns.
  struct PlacedAnswer {
    const AnswerColumn* what = nullptr;
    const Question* question = nullptr;
    std::size_t column = 0;
    std::optional<std::size_t> response_time;
    Conditions when;
    std::vector<std::size_t> choice_of = {};
  };
  using Row = SourceTable::Row;
  /// The columns of one stimulus, with their places.
  struct PlacedStimulus {
    CellMatch match;
    std::map<std::string, std::size_t> stated;  ///< of "shown_mean_fps" and its siblings
    std::string frames_file;
  };

  PlacedStimulus placed_stimulus(const Protocol& protocol, const StimulusColumns& columns) const;
  Conditions placed(const std::vector<RowCondition>& conditions) const;
  static bool takes(const Conditions& conditions, const Row& row);
  std::vector<std::string> left_columns() const;
  std::optional<std::size_t> place(const char* key) const;
  std::string code_in(const Row& row) const;
  Visit& visit_of(const Row& row);
  std::optional<std::string> observer_of(const Row& row) const;
  bool is_test(const Row& row) const;
  void add(const Row& row, std::size_t number);
  ImportedTrial new_trial(const Row& row, const std::vector<int>& cells) const;
  ImportedShowing showing(const Row& row, const PlacedStimulus& stimulus, int cell) const;
  std::optional<std::int64_t> onset_in(const Row& row) const;
  std::optional<double> stated(const PlacedStimulus& stimulus, const char* key, const Row& row,
                               double least) const;
  void add_frames(ImportedShowing& showing, const std::string& frames_file, const Row& row) const;
  std::string text_of(const PlacedAnswer& answer, const Row& row) const;
  int score_in(const PlacedAnswer& answer, const Row& row, const std::string& text) const;
  int chosen_in(const PlacedAnswer& answer, const Row& row, const std::string& text) const;
  void add_answer(ImportedTrial& trial, const PlacedAnswer& answer, const Row& row) const;

  const ImportMapping& mapping_;
  const SourceTable& table_;
  Visits& visits_;
  std::vector<PlacedStimulus> stimuli_;        ///< in the order in which a trial shows them
  std::map<std::string, std::size_t> places_;  ///< of ImportMapping::columns
  Conditions rows_;
  std::optional<std::size_t> onset_;
  std::vector<PlacedAnswer> answers_;
};

}  // namespace study
