#include "apps/view/options.hpp"
#include "stats/base/error.hpp"

namespace apps {

void run_window(const ViewOptions&) {
  throw base::Error("window", "this build has no windows (VIP_WINDOW=OFF)",
                    "use --headless --png FOLDER, or build with -DVIP_WINDOW=ON");
}

}  // namespace apps
