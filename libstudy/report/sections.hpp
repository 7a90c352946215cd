#pragma once
/// The page's sections; each is "" if the results lack its contents.

#include <array>
#include <string>
#include <vector>

#include "libstudy/report/field.hpp"

namespace study::report {

/// A part of a study, by its name in the results.
struct Part {
  const char* key;
  const char* title;
};
inline constexpr std::array<Part, 4> all_parts{
    {{"pilot", "Pilot"}, {"task1", "Task 1"}, {"task2", "Task 2"}, {"own", "Own design"}}};

/// The results, followed by the documents in "apart": another protocol of a task, or another question.
std::vector<Field> documents(const Field& root);

/// Joins names as "Pilot, Task 1 and Task 2"; "" without names.
std::string enumerated(const std::vector<std::string>& names);

/// True if the hypotheses of a task ("task1", "task2") were fixed beforehand: a bundle was given, is intact,
/// holds the study's protocol and the tests as they were made, and is older than the first answer.
bool preregistered(const Field& root, const std::string& task);

std::string head_section(const Field& root);
std::string decisions_section(const Field& root);
/// The parts of the study that the built-in analyses do not cover, and why.
std::string not_analysed_section(const Field& root);
std::string methods_section(const Field& root);
std::string participants_section(const Field& root);
std::string timing_section(const Field& root);
/// Answers of each question in each cell, of any protocol.
std::string descriptives_section(const Field& root);
/// The cost and error of frames, beside people's answers.
std::string costs_section(const Field& root);
std::string pilot_section(const Field& root);
std::string task1_section(const Field& root);
/// Part of Task 1's section: the participants of pairs, the mixed model, tipping points.
std::string missing_answers(const Field& root);
std::string task2_section(const Field& root);
/// Part of a task's section if effects are a factor: the meaning of a method, and the effect of each level.
std::string treatment_note(const Field& task);
/// label_of() returns the name of the score of an entry of the results. The functions after it return parts
/// of the sections: counts of ratings, response times, reliability of scores of several items, methods by
/// n_*, and the smallest detectable effect.
std::string label_of(const Field& task1, const Field& entry);
std::string pilot_ratings(const Field& pilot);
std::string score_ratings(const Field& task1, const Field& score);
std::string response_times(const Field& root, const std::string& task);
std::string reliability(const Field& task1);
std::string by_n_star(const Field& task1);
std::string detectable_scores(const Field& task1);
std::string detectable_preference(const Field& task2);
/// Part of the participants' section: their answers outside the trials.
std::string people_tables(const Field& root);
std::string score_factors(const Field& task1);
std::string preference_factors(const Field& task2);
std::string sickness_section(const Field& root);
std::string hypotheses_section(const Field& root);
std::string sensitivity_section(const Field& root);
std::string preregistration_section(const Field& root);
std::string provenance_section(const Field& root);

}  // namespace study::report
