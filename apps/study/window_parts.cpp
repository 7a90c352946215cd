#include "apps/study/window_parts.hpp"

#include "stats/base/error.hpp"

namespace apps {

WindowParts make_window_parts(const RunOptions&, const study::Protocol&) {
  throw base::Error("--display window", "this version shows no window yet",
                    "use --display headless or none with --observer");
}

}  // namespace apps
