#include "apps/stats/report/html.hpp"

namespace apps::report {

std::string badge(bool preregistered) {
  return preregistered ? "<span class=\"badge\">Preregistered</span>"
                       : "<span class=\"badge exploratory\">Exploratory</span>";
}

}  // namespace apps::report
