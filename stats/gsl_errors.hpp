#pragma once
/// GSL's error handling. By default GSL aborts the process on an error. Every file that calls GSL therefore
/// calls use_gsl_codes() first and checks the return codes.

namespace stats {

/// Turns GSL's aborting error handler off, once for the process.
void use_gsl_codes();

/// Version of GSL at run time, e.g. "2.7.1".
const char* gsl_library_version();

}  // namespace stats
