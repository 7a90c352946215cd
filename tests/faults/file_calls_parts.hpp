#pragma once
/// Counting, failing and recording of the libc calls in file_calls_libc.cpp.

#include <sys/stat.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

#include "tests/faults/call_log.hpp"

namespace faults::calls {

enum class Need { Room, Nothing };  ///< whether the call fails on a full disk
enum class Act { Go, Half, Fail };
using Done = Call::Kind;

/// Makes recorded calls take turns, so that they are recorded in order.
class Turn {
 public:
  Turn();

 private:
  std::lock_guard<std::recursive_mutex> guard_;
};

[[noreturn]] void die();
std::string path_of(int fd);
/// Full path, or empty if calls on it do not count.
std::string watched_at(int folder, const char* path);
bool watched(int fd);
struct stat look(int fd);
struct stat look(const std::string& path);
/// False for a file that does not exist.
inline bool stands(const struct stat& found) { return found.st_nlink > 0; }
bool records();
bool exchanges();  ///< false if swapping two names must fail
std::int64_t clock_ahead_s();
/// Does nothing if calls are not recorded.
void record(Done kind, std::uint64_t file, std::int64_t at, std::string_view path, std::string_view to = {},
            std::string_view bytes = {});
/// Counts a call; does not return if the program is to be killed before it.
Act count(Need need);
/// count() for a call that cannot be done in part. True if the call must fail; does not return if the program
/// is to be killed before or in it.
bool refuse(Need need);
/// If the plan counts reads, counts a read of a watched file. True if the call must fail.
bool refuse_read(int fd);
bool refuse_read(int folder, const char* path);

}  // namespace faults::calls
