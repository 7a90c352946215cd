#include "libstudy/runner/window_parts.hpp"
#include "stats/base/error.hpp"

namespace study {

WindowParts make_window_parts(const RunOptions&, const Protocol&) {
  throw base::Error("--display window", "this build has no windows (VIP_WINDOW=OFF)",
                    "use --display headless or none with --observer, or build with -DVIP_WINDOW=ON");
}

std::shared_ptr<void> open_headset_mirror(HeadsetDisplay&, bool) {
  throw base::Error("--mirror", "this build has no windows (VIP_WINDOW=OFF)",
                    "leave it out, or build with -DVIP_WINDOW=ON");
}

}  // namespace study
