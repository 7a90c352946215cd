#pragma once
/// A checkpoint of Table 1 as a file, so that several versions of the program can start from the same water
/// and picture: a text header that says what it belongs to, then the compressed particles and picture, with
/// their SHA-256.

#include <filesystem>
#include <string>

#include "libsim/measure/cells.hpp"
#include "libsim/measure/checkpoint.hpp"
#include "stats/base/picture_size.hpp"

namespace measure {

/// What identifies a checkpoint.
struct CheckpointOf {
  std::string scene;         ///< as in the paper's tables
  std::string scene_sha256;  ///< of the scene's file
  std::int64_t n_star = 0;
  int frame = 0;
  base::PictureSize size;  ///< of the checkpoint's picture
};

/// SingleDam_32768_f060.checkpoint
std::string checkpoint_name(const CheckpointOf& of);

/// Writes a file of that name into an existing folder, by rename.
void write_checkpoint(const std::filesystem::path& folder, const CheckpointOf& of,
                      const Checkpoint& checkpoint);

/// First digits of the SHA-256 of particles and picture: runs with equal digests start from the same water.
std::string checkpoint_digest(const Checkpoint& checkpoint);

/// base::Error at the file if it is missing, damaged, not a checkpoint, or another checkpoint (which is
/// named).
Checkpoint read_checkpoint(const std::filesystem::path& folder, const CheckpointOf& of);

}  // namespace measure
