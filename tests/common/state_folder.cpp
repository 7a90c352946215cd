/// Gives each test program, and the programs it starts, its own register of exports: tests never write into
/// the user's home.
#include <unistd.h>

#include <cstdlib>

#include "tests/common/temporary_folder.hpp"

namespace {

class StateFolder {
 public:
  StateFolder() { ::setenv("VIP_STATE_DIR", folder_->path().c_str(), 0); }
  ~StateFolder() {
    if (::getpid() == maker_) delete folder_;  // an exiting child leaves it to its parent
  }

 private:
  const pid_t maker_ = ::getpid();
  test::TemporaryFolder* const folder_ = new test::TemporaryFolder;
};

const StateFolder state_folder;

}  // namespace
