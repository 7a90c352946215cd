#pragma once
/// Includes toml++; only for toml.cpp and its tests. toml++ 3.3 asserts conditions that malformed documents
/// violate, such as that a key begins at the current character. This header disables the assertions: a
/// violated one would end the program, while without assertions toml++ reports an ordinary error. With clang
/// toml++ also gives the conditions to the compiler as assumptions. Violating an assumption is undefined
/// behaviour, so this header removes them too.

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
