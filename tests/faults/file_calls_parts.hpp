#pragma once
/// How the calls of libc (file_calls_libc.cpp) are counted, failed and recorded.

#include <sys/stat.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

#include "tests/faults/call_log.hpp"

namespace faults::calls {

enum class Need { Room, Nothing };  ///< whether a full disk makes the call fail
enum class Act { Go, Half, Fail };
using Done = Call::Kind;

/// Calls that are recorded take turns, so that they stand in their order.
class Turn {
 public:
  Turn();

 private:
  std::lock_guard<std::recursive_mutex> guard_;
};

[[noreturn]] void die();
std::string path_of(int fd);
/// Whole path, or empty where calls on it do not count.
std::string watched_at(int folder, const char* path);
bool watched(int fd);
struct stat look(int fd);
struct stat look(const std::string& path);
/// False of a file that is not there.
inline bool stands(const struct stat& found) { return found.st_nlink > 0; }
bool records();
bool exchanges();  ///< whether two names may change places
std::int64_t clock_ahead_s();
/// Nothing where calls are not recorded.
void record(Done kind, std::uint64_t file, std::int64_t at, std::string_view path, std::string_view to = {},
            std::string_view bytes = {});
/// Counts a call; does not return where the program is to end before it.
Act count(Need need);
/// For calls that are done whole or not at all.
bool refuse(Need need);

}  // namespace faults::calls
