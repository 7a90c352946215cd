#pragma once
/// Finds the cell of a protocol that a row of another program's table shows.

#include <string>
#include <utility>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/store/import/mapping.hpp"
#include "libstudy/store/import/source_table.hpp"

namespace study {

class CellMatch {
 public:
  /// stimulus: the columns of one stimulus, beside those of `shared`. base::Error if the table lacks a column
  /// that the mapping names, or the mapping a factor that the protocol has not.
  CellMatch(const Protocol& protocol, const StimulusColumns& shared, const StimulusColumns& stimulus,
            const SourceTable& table);

  /// Index of the only cell with the row's setting. base::Error at file:line, with the columns, if no cell or
  /// more than one has it.
  int cell_of(const SourceTable::Row& row) const;

 private:
  void add_keys(const StimulusColumns& columns);

  struct Key {
    std::string what;  ///< "mean_fps", ..., or the name of a factor
    std::size_t place = 0;
    std::size_t factor = 0;  ///< index into Design::factors
    bool is_factor = false;
  };

  bool fits(const Cell& cell, const Key& key, const std::string& text) const;
  std::string words_of(const SourceTable::Row& row) const;

  const Protocol& protocol_;
  const SourceTable& table_;
  std::vector<Key> keys_;
};

/// The number in a field, whose decimal sign may be a comma if commas do not separate fields. base::Error at
/// the row for any other text and for a number that is not finite.
double number_in(const SourceTable& table, const SourceTable::Row& row, std::size_t place);
/// The same for a whole number from `low` to `high`; "3.0" counts as whole.
int whole_number_in(const SourceTable& table, const SourceTable::Row& row, std::size_t place, int low,
                    int high);
/// A base::Error at a field: file:line, the column, and the field's text.
[[noreturn]] void fail_at_field(const SourceTable& table, const SourceTable::Row& row, std::size_t place,
                                const std::string& problem, const std::string& mend);

}  // namespace study
