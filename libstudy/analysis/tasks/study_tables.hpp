#pragma once
/// Descriptive tables of a study with factors: design, groups, answers by cell, thresholds, participants.

#include <set>
#include <span>
#include <string>
#include <vector>

#include "libstudy/analysis/json_parts.hpp"
#include "libstudy/analysis/tasks/cell_values.hpp"

namespace study {

/// The design: factors with levels, standard, surfaces, procedure.
Json design_json(const Design& design);

/// Analysed participants by group of the between-subject factors; empty without such a factor.
Json groups_json(const TaskData& data);

/// One entry for each question. Its "cells" has an entry for each cell, or pair of cells, with answers:
/// numbers of participants and trials; mean, SD and interval of the participants' means; counts of each
/// score. `declared`: ids of the questions in declared hypotheses; other questions are marked as exploratory.
Json answers_by_cell_json(const TaskData& data, double confidence, const std::vector<std::string>& declared);

/// Threshold and shape of each track of each participant; by track the mean threshold over participants, the
/// share of positive answers at each level, and the mean psychometric function. Null without `tracks`.
/// `declared`: true if a hypothesis tests the thresholds, which then are not marked as exploratory.
Json thresholds_json(const TaskData& data, std::span<const PersonTrack> tracks, double confidence,
                     bool declared);

/// Each participant with sessions. `earlier`: uids of the sessions of an earlier analysis; null: none, and no
/// participant is marked as new.
Json participants_json(const TaskData& data, const std::set<std::string>* earlier);

}  // namespace study
