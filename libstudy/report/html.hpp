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

/// "Preregistered" or "Exploratory": a word, never a colour alone.
inline std::string badge(bool preregistered) {
  return preregistered ? "<span class=\"badge\">Preregistered</span>"
                       : "<span class=\"badge exploratory\">Exploratory</span>";
}

}  // namespace study::report
