#pragma once
/// GSL's error handling. By default GSL aborts the process on an error. After use_gsl_codes() its functions
/// return error codes or NaN instead.

namespace stats {

/// Turns GSL's aborting error handler off, once for the process.
void use_gsl_codes();

/// Version of GSL at run time, e.g. "2.7.1".
const char* gsl_library_version();

}  // namespace stats
