#pragma once
/// The page's sections, each "" when the results lack what it shows.

#include <string>

#include "apps/stats/report/field.hpp"

namespace apps::report {

/// Whether the hypotheses of a task ("task1", "task2") were fixed beforehand: a bundle was given, is whole,
/// and holds the study's protocol and the tests as they were made.
bool preregistered(const Field& root, const std::string& task);

std::string head_section(const Field& root);
std::string decisions_section(const Field& root);
std::string methods_section(const Field& root);
std::string participants_section(const Field& root);
std::string timing_section(const Field& root);
std::string pilot_section(const Field& root);
std::string task1_section(const Field& root);
std::string task2_section(const Field& root);
std::string sickness_section(const Field& root);
std::string hypotheses_section(const Field& root);
std::string sensitivity_section(const Field& root);
std::string preregistration_section(const Field& root);
std::string provenance_section(const Field& root);

}  // namespace apps::report
