#pragma once
/// All bakes of a protocol: made, kept where they are good, made again where they are not.

#include <filesystem>
#include <functional>

#include "apps/study/bakes/bake_plan.hpp"

namespace apps {

struct ProtocolBakes {
  std::string file;  ///< of the protocol
  std::filesystem::path folder;
  SessionLook look;
  bool pictures = false;  ///< keep them too
};

/// Bytes that a bake takes at most, by the particles and pixels of its header; max_particles is not asked.
std::uint64_t most_bytes(const sim::BakeHeader& header);

/// Makes the bakes of plan_bakes() in `folder`, which is made where it is missing; says on stdout what it
/// keeps, makes and leaves out. A bake that is there is read whole and kept when it holds what is wanted,
/// made by this version and renderer. `stop` is asked before each frame and ends the work by throwing: what
/// is complete stays. base::Error: nothing can be baked, too little room on the disk, what write_bake()
/// meets.
void bake_protocol(const study::Protocol& protocol, const ProtocolBakes& wish,
                   const std::function<void()>& stop);

}  // namespace apps
