#pragma once
/// States of the disk after the power fails at some call of a command.
///
/// Two models of what a file system keeps of unsynced calls:
///
/// Ext4 (data=ordered): names, and sizes that shrink, become durable in order; any sync makes all earlier
/// names durable. A file never grows by bytes that were not written. Overwritten bytes become durable in
/// sectors of 512, in any order, until their file is synced. Renaming a file that was not synced may leave it
/// empty (noauto_da_alloc).
///
/// Posix, with btrfs' guarantees: any call may be lost or kept, independent of those before and after it. A
/// sync of a file makes its bytes and its current name durable; a sync of a folder makes its names durable,
/// including removals. A rename is kept whole or not at all. A call that depends on another one is not kept
/// without it.
///
/// The index of SQLite's log (-shm) is never on a disk.

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "tests/faults/call_log.hpp"

namespace faults {

/// Files and folders below one folder, by full path.
struct Tree {
  struct Name {
    std::uint64_t file = 0;
    bool folder = false;
  };
  std::map<std::string, Name> names;
  std::map<std::uint64_t, std::string> files;  ///< bytes of each file, by its number
};

Tree read_tree(const std::filesystem::path& folder);
/// Replaces the folder's content.
void write_tree(const Tree& tree, const std::filesystem::path& folder);
/// Equal for trees with equal names and bytes.
std::size_t hash_of(const Tree& tree);

enum class Model { Ext4, Posix };
const char* name_of(Model model);

/// Which of the calls that may be lost are kept.
enum class Kept {
  Least,  ///< none of them
  Most,   ///< all of them
  Some    ///< a random choice from a seed; writes by sectors
};

/// The disk after the first `count` calls, starting from `before`.
Tree crash_state(const Tree& before, const std::vector<Call>& calls, std::size_t count, Model model,
                 Kept kept, unsigned seed = 0);

}  // namespace faults
