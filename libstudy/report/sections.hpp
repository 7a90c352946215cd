#pragma once
/// Functions that render the sections of the page as HTML. A section is "" if the results lack its contents.

#include <array>
#include <string>
#include <vector>

#include "libstudy/report/field.hpp"

namespace study::report {

/// A part of a study: its key in the results' JSON and its title.
struct Part {
  const char* key;
  const char* title;
};
inline constexpr std::array<Part, 4> all_parts{
    {{"pilot", "Pilot"}, {"task1", "Task 1"}, {"task2", "Task 2"}, {"own", "Own design"}}};

/// The main results document, followed by the documents of its list "apart": the analyses beyond the first of
/// each task.
std::vector<Field> documents(const Field& root);

/// True if a task ("task1", "task2", "pilot") was preregistered: a bundle was given, it is intact, it holds
/// the study's protocol and the hypotheses as they were tested, and it is older than the first answer or no
/// answer has a time.
bool preregistered(const Field& root, const std::string& task);

std::string head_section(const Field& root);
std::string decisions_section(const Field& root);
/// Lists the parts of the study that the built-in analyses do not cover, with reasons.
std::string not_analysed_section(const Field& root);
std::string methods_section(const Field& root);
std::string participants_section(const Field& root);
std::string timing_section(const Field& root);
/// A table of a task's showings by station; "" if all are of one station. title: the task's; may be empty.
std::string station_timing(const Field& root, const std::string& task, const std::string& title);
/// Describes the answers to each question in each cell, for any protocol.
std::string descriptives_section(const Field& root);
/// Time and error of each stimulus's frames, beside the answers to it.
std::string costs_section(const Field& root);
std::string pilot_section(const Field& root);
std::string task1_section(const Field& root);
/// Part of Task 1's section on missing answers: number of participants in each comparison, the mixed model,
/// and tipping points (by how many points missing answers must be worse before a decision changes).
std::string missing_answers(const Field& root);
std::string task2_section(const Field& root);
/// Part of a task's section if effects are a factor: a note that each "method" is a method with a level of
/// effects.
std::string treatment_note(const Field& task);
/// The label of the score to which an entry of task1 belongs.
std::string label_of(const Field& task1, const Field& entry);
// Parts of sections: counts of ratings, response times, reliability, differences between n_*, smallest
// detectable effects.
std::string pilot_ratings(const Field& pilot);
std::string score_ratings(const Field& task1, const Field& score);
std::string response_times(const Field& root, const std::string& task);
std::string reliability(const Field& task1);
std::string by_n_star(const Field& task1);
std::string detectable_scores(const Field& task1);
std::string detectable_preference(const Field& task2);
/// Part of the participants' section: tables of their answers about themselves.
std::string people_tables(const Field& root);
std::string score_factors(const Field& task1);
std::string preference_factors(const Field& task2);
std::string sickness_section(const Field& root);
std::string hypotheses_section(const Field& root);
std::string sensitivity_section(const Field& root);
std::string preregistration_section(const Field& root);
std::string provenance_section(const Field& root);

}  // namespace study::report
