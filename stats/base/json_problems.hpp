#pragma once
/// What is wrong with a JSON text, in words for the person who has the file.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace base {

struct RepeatedKey {
  std::string key;
  std::size_t entry = 0;  ///< element of the outermost list that holds the object, from 1; 0: no list does
};

/// Why a text is no JSON and where: "it ends too early, at line 3, column 1". message: of the JsonError that
/// reading it threw.
std::string json_problem(const std::string& message);

/// The first key that an object of the text names a second time, at any depth. None if there is no such key,
/// or if the text is not JSON. A parsed Json has one member for each key, so that only the text shows it.
std::optional<RepeatedKey> repeated_key(std::string_view json);

}  // namespace base
