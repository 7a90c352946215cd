#pragma once
/// liblsl, opened at run time: programs also start without it.

#include <dlfcn.h>

#include <string>

namespace study {

/// Opens liblsl, or what VIP_LSL_LIBRARY names. The library stays open, because it leaves threads behind.
/// base::Error naming `place` if there is none.
void* open_lsl_library(const std::string& place);

/// base::Error: the library has no function of this name.
[[noreturn]] void refuse_lsl_library(const std::string& place, const char* name);

/// Sets `function` to the library's function of this name; base::Error if there is none.
template <class F>
void find_lsl_function(void* library, const std::string& place, const char* name, F& function) {
  function = reinterpret_cast<F>(::dlsym(library, name));
  if (!function) refuse_lsl_library(place, name);
}

}  // namespace study
