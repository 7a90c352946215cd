/// A register of exports of each test program's own, for itself and the programs that it starts: tests never
/// write into the home of whoever runs them.
#include <unistd.h>

#include <cstdlib>

#include "tests/common/temporary_folder.hpp"

namespace {

class StateFolder {
 public:
  StateFolder() { ::setenv("VIP_STATE_DIR", folder_->path().c_str(), 0); }
  ~StateFolder() {
    if (::getpid() == maker_) delete folder_;  // the end of a child leaves it to its parent
  }

 private:
  const pid_t maker_ = ::getpid();
  test::TemporaryFolder* const folder_ = new test::TemporaryFolder;
};

const StateFolder state_folder;

}  // namespace
