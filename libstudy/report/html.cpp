#include "libstudy/report/html.hpp"

namespace study::report {

std::string badge(bool preregistered) {
  return preregistered ? "<span class=\"badge\">Preregistered</span>"
                       : "<span class=\"badge exploratory\">Exploratory</span>";
}

}  // namespace study::report
