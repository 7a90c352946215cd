#pragma once
/// GSL's error handling, in one place. By default GSL aborts the process; every file that calls GSL says
/// use_gsl_codes() first and reads the codes.

namespace stats {

/// Switches GSL's aborting handler off, once for the process.
void use_gsl_codes();

/// Version of GSL at run time, e.g. "2.7.1".
const char* gsl_library_version();

}  // namespace stats
