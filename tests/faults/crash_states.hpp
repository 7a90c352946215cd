#pragma once
/// What may stand on the disk when the power goes after so many calls of a command.
///
/// Two models of what a file system keeps of calls that were not synced:
///
/// Ext4 (data=ordered): names, and sizes that shrink, become durable in their order; a sync of anything makes
/// all names before it durable. A file grows by no bytes that were not written. Bytes written over others
/// are durable by sectors of 512, in any order, until their file is synced. Renaming a file that was not
/// synced may leave it empty (noauto_da_alloc).
///
/// Posix, with btrfs' promises: any call may be lost or kept, whatever came before or after. A sync of a file
/// makes its bytes and the name that it has then durable; a sync of a folder makes the names in it durable,
/// also those that went. A rename is whole or not there. A call that builds on another one is not kept
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

/// Files and folders below one folder, by their whole paths.
struct Tree {
  struct Name {
    std::uint64_t file = 0;
    bool folder = false;
  };
  std::map<std::string, Name> names;
  std::map<std::uint64_t, std::string> files;  ///< bytes
};

Tree read_tree(const std::filesystem::path& folder);
/// What stood below the folder is gone.
void write_tree(const Tree& tree, const std::filesystem::path& folder);
/// Equal for equal names and bytes.
std::size_t hash_of(const Tree& tree);

enum class Model { Ext4, Posix };
const char* name_of(Model model);

/// Which of the calls that may be lost are.
enum class Kept {
  Least,  ///< all of them
  Most,   ///< none
  Some    ///< by chance, from a seed; writes by sectors
};

/// The disk after the first `count` calls that `before` went through.
Tree crash_state(const Tree& before, const std::vector<Call>& calls, std::size_t count, Model model,
                 Kept kept, unsigned seed = 0);

}  // namespace faults
