/// Unless VIP_STATE_DIR is already set, gives each test program, and the programs that it starts, its own
/// register of exports, so that tests do not write into the user's home.
#include <unistd.h>

#include <cstdlib>

#include "tests/common/temporary_folder.hpp"

namespace {

class StateFolder {
 public:
  StateFolder() { ::setenv("VIP_STATE_DIR", folder_->path().c_str(), 0); }
  ~StateFolder() {
    if (::getpid() == maker_) delete folder_;  // a forked child must not delete its parent's folder
  }

 private:
  const pid_t maker_ = ::getpid();
  test::TemporaryFolder* const folder_ = new test::TemporaryFolder;
};

const StateFolder state_folder;

}  // namespace
