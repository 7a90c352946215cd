#pragma once
/// Includes toml++; only for toml.cpp and its tests. Version 3.3 asserts properties
/// that malformed documents violate ("here begins a key"); with assertions disabled it goes on to report a
/// proper error. So they are disabled here: enabled, they would end the program, and as assumptions for the
/// compiler (clang) they would be undefined behaviour.

#pragma push_macro("NDEBUG")
#undef NDEBUG
#define NDEBUG
#ifdef __clang__
#define __builtin_assume(...) static_cast<void>(0)
#endif
#include <toml++/toml.h>
#ifdef __clang__
#undef __builtin_assume
#endif
#pragma pop_macro("NDEBUG")
