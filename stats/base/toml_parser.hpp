#pragma once
/// toml++, seen by toml.cpp, what stands behind it and its tests alone. Version 3.3 asserts of a document
/// what broken ones do not keep
/// ("here begins a key"), and goes on to a proper error where such an assertion is empty. So they are: as
/// assertions they would end the program, and as promises to the compiler (clang) be undefined behaviour.

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
