#pragma once
/// Writes the report, an HTML page with a study's results.

#include <string>

#include "stats/base/json.hpp"

namespace study::report {

/// Renders a JSON document of schema vip-results/1 (docs/report.md) as one HTML page, from this document
/// alone. The page has no script, loads nothing, and has a style sheet for screen and print. base::Error for
/// another schema.
std::string results_page(const base::Json& results);

/// Renders a JSON document of schema vip-study/1 (a study with factors) as an HTML page of the same kind.
/// base::Error for another schema.
std::string factor_study_page(const base::Json& results);

}  // namespace study::report
