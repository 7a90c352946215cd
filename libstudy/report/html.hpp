#pragma once
/// HTML elements of the report's page.

#include <string>

#include "stats/figures/html.hpp"

namespace study::report {

using html::details;
using html::figure;
using html::list;
using html::paragraph;
using html::section;
using html::subsection;
using html::Table;
using html::whole_page;

/// A label with the word "Preregistered" or "Exploratory", so that colour is not needed to distinguish them.
inline std::string badge(bool preregistered) {
  return preregistered ? "<span class=\"badge\">Preregistered</span>"
                       : "<span class=\"badge exploratory\">Exploratory</span>";
}

}  // namespace study::report
