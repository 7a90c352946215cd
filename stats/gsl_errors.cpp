#include "stats/gsl_errors.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_version.h>

namespace stats {

void use_gsl_codes() {
  static const bool off = (gsl_set_error_handler_off(), true);
  static_cast<void>(off);
}

const char* gsl_library_version() { return ::gsl_version; }

}  // namespace stats
