#pragma once
/// Keys that a JSON text gives twice. A parsed base::Json has one member for each key, so only the text shows
/// them.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace base {

struct RepeatedKey {
  std::string key;
  std::size_t entry = 0;  ///< element of the outermost list that holds the object, from 1; 0: no list does
};

/// The first key that an object of the text names a second time, at any depth. None if there is no such key,
/// or if the text is not JSON.
std::optional<RepeatedKey> repeated_key(std::string_view json);

}  // namespace base
