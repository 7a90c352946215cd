#pragma once
/// The page's sections, each "" when the results lack what it shows.

#include <array>
#include <string>
#include <vector>

#include "apps/stats/report/field.hpp"

namespace apps::report {

/// What a study may hold, by its name in the results.
struct Part {
  const char* key;
  const char* title;
};
inline constexpr std::array<Part, 4> all_parts{
    {{"pilot", "Pilot"}, {"task1", "Task 1"}, {"task2", "Task 2"}, {"own", "Own design"}}};

/// The results, and behind them those that are apart: another protocol of a task, or another question.
std::vector<Field> documents(const Field& root);

/// "Pilot, Task 1 and Task 2"; "" of none.
std::string enumerated(const std::vector<std::string>& names);

/// Whether the hypotheses of a task ("task1", "task2") were fixed beforehand: a bundle was given, is whole,
/// holds the study's protocol and the tests as they were made, and is older than the first answer.
bool preregistered(const Field& root, const std::string& task);

std::string head_section(const Field& root);
std::string decisions_section(const Field& root);
/// What of the study the shipped analyses do not cover, and why.
std::string not_analysed_section(const Field& root);
std::string methods_section(const Field& root);
std::string participants_section(const Field& root);
std::string timing_section(const Field& root);
/// Answers of each question in each cell, of any protocol.
std::string descriptives_section(const Field& root);
/// What frames cost and what error they carried, beside what people said.
std::string costs_section(const Field& root);
std::string pilot_section(const Field& root);
std::string task1_section(const Field& root);
/// Of the section of Task 1: on whom pairs rest, the mixed model, tipping points.
std::string missing_answers(const Field& root);
std::string task2_section(const Field& root);
/// Of the sections of the tasks, where effects are a factor: what a method is, and what each level is worth.
std::string treatment_note(const Field& task);
/// Of the sections of the parts: ratings by how often each was given, times of response, reliability of
/// scores of several items, methods at one n_* and another, the smallest effect that could be found.
/// The name of the score that an entry of the results is about.
std::string label_of(const Field& task1, const Field& entry);
std::string pilot_ratings(const Field& pilot);
std::string score_ratings(const Field& task1, const Field& score);
std::string response_times(const Field& root, const std::string& task);
std::string reliability(const Field& task1);
std::string by_n_star(const Field& task1);
std::string detectable_scores(const Field& task1);
std::string detectable_preference(const Field& task2);
/// Of the section of participants: what they answered outside the trials.
std::string people_tables(const Field& root);
std::string score_factors(const Field& task1);
std::string preference_factors(const Field& task2);
std::string sickness_section(const Field& root);
std::string hypotheses_section(const Field& root);
std::string sensitivity_section(const Field& root);
std::string preregistration_section(const Field& root);
std::string provenance_section(const Field& root);

}  // namespace apps::report
