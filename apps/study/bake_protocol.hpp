#pragma once
/// Makes all bakes (files of precomputed frames) of a protocol; keeps valid ones and replaces invalid ones.

#include <filesystem>
#include <functional>

#include "libstudy/stimulus/bakes/bake_plan.hpp"

namespace apps {

struct ProtocolBakes {
  std::string file;  ///< path of the protocol file
  std::filesystem::path folder;
  study::SessionLook look;
  bool pictures = false;  ///< true: also store pictures
};

/// Upper bound of a bake's size, bytes, from method, n_*, frames, temperatures, foam and pixels in its
/// header.
std::uint64_t most_bytes(const sim::BakeHeader& header);

/// Makes the bakes of plan_bakes() in `folder`, which is made if missing; prints on stdout which bakes exist
/// and are valid, which are made, and how many stimuli run live. An existing bake is valid if its header has
/// the wanted fluid, view and pictures and this version and renderer, and if all its frames can be read.
/// `stop` is called before each frame and may throw to stop baking; complete bakes remain. base::Error:
/// nothing can be baked, too little disk space, errors of write_bake().
void bake_protocol(const study::Protocol& protocol, const ProtocolBakes& request,
                   const std::function<void()>& stop);

}  // namespace apps
