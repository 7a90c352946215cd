#pragma once
/// A checkpoint of Table 1 as a file, so that runs of several trees start from the same water and picture: a
/// head of lines of text that says what it belongs to, then particles and picture, packed, with their
/// SHA-256.

#include <filesystem>
#include <string>

#include "apps/bench/cells.hpp"
#include "apps/bench/checkpoint.hpp"
#include "apps/common/picture_size.hpp"

namespace apps {

/// What a checkpoint belongs to.
struct CheckpointOf {
  std::string scene;         ///< as in the paper's tables
  std::string scene_sha256;  ///< of the scene's file
  std::int64_t n_star = 0;
  int frame = 0;
  PictureSize size;  ///< of the picture that is seen
};

/// SingleDam_32768_f060.checkpoint
std::string checkpoint_name(const CheckpointOf& of);

/// Writes a file of that name in a folder that is there, by rename.
void write_checkpoint(const std::filesystem::path& folder, const CheckpointOf& of,
                      const Checkpoint& checkpoint);

/// Digits of the SHA-256 of particles and picture: runs with the same ones start from the same water.
std::string checkpoint_digest(const Checkpoint& checkpoint);

/// base::Error at the file: missing, no checkpoint, of something else (which is named), damaged.
Checkpoint read_checkpoint(const std::filesystem::path& folder, const CheckpointOf& of);

}  // namespace apps
