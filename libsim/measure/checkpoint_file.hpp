#pragma once
/// A checkpoint of Table 1 as a file, so that several versions of the program can start from the same water
/// and picture: a text header with the fields of CheckpointOf, then the compressed particles and picture,
/// with their SHA-256.

#include <filesystem>
#include <string>

#include "libsim/measure/cells.hpp"
#include "libsim/measure/checkpoint.hpp"
#include "stats/base/picture_size.hpp"

namespace measure {

/// The properties that identify a checkpoint.
struct CheckpointOf {
  std::string scene;         ///< name in the paper's tables, such as SingleDam
  std::string scene_sha256;  ///< of the scene's file
  std::int64_t n_star = 0;
  int frame = 0;
  base::PictureSize size;  ///< of the checkpoint's picture
};

/// File name of a checkpoint, such as SingleDam_32768_f060.checkpoint.
std::string checkpoint_name(const CheckpointOf& of);

/// Writes the checkpoint to the file checkpoint_name(of) in an existing folder; a rename replaces an older
/// file.
void write_checkpoint(const std::filesystem::path& folder, const CheckpointOf& of,
                      const Checkpoint& checkpoint);

/// First 12 digits of the SHA-256 of particles and picture: runs with equal digests start from the same
/// water.
std::string checkpoint_digest(const Checkpoint& checkpoint);

/// Reads the file checkpoint_name(of). base::Error at the file if it is missing, damaged, not a checkpoint,
/// or has other fields than `of`; the first different field is named.
Checkpoint read_checkpoint(const std::filesystem::path& folder, const CheckpointOf& of);

}  // namespace measure
