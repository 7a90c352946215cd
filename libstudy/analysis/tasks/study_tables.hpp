#pragma once
/// Tables of a study with factors that no hypothesis declares: answers by cell, thresholds, participants.

#include <set>
#include <span>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/tasks/cell_values.hpp"

namespace study {

/// The design: factors with levels, standard, procedure.
Json design_json(const Design& design);

/// Analysed participants by group of the between-subject factors; empty without such a factor.
Json groups_json(const TaskData& data);

/// Each question in each cell: participants, trials, and over participants mean, SD and interval of their
/// means; counts of each score. `declared`: outcomes of declared hypotheses; the tables of other questions
/// are exploratory.
Json answers_by_cell_json(const TaskData& data, double confidence, const std::vector<std::string>& declared);

/// Threshold and shape of each track of each participant, their mean over participants, and by track the
/// share of positive answers at each level with the mean psychometric function. Null without a procedure
/// that estimates a threshold.
Json thresholds_json(const TaskData& data, std::span<const PersonTrack> tracks, double confidence,
                     bool declared);

/// Each participant with sessions. `earlier`: uids of the sessions of an earlier analysis; null: none, and no
/// participant is marked as new.
Json participants_json(const TaskData& data, const std::set<std::string>* earlier);

}  // namespace study
