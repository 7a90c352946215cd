#pragma once
/// The report: one HTML page of a study's results.

#include <string>

#include "stats/base/json.hpp"

namespace study::report {

/// Renders a document of schema vip-results/1 (docs/report.md), and only that, as a page: no script, no
/// outside resource, a style sheet for screen and print. base::Error for another schema.
std::string results_page(const base::Json& results);

}  // namespace study::report
