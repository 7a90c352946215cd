#pragma once
/// Runs timed runs one after the other, because parallel runs on one machine disturb each other's times.

namespace study {

/// The machine's lock for timed runs of all users: flock() on the file vip-bench.lock in $VIP_LOCK_DIR, or
/// else in the first of /run/lock and /tmp that every user may write to. The constructor waits for it; a
/// program that waits says so once on stderr. The lock is released with the object, and when the program is
/// killed. base::Error if there is no such folder, or the file cannot be opened.
class MachineLock {
 public:
  MachineLock();
  ~MachineLock();
  MachineLock(const MachineLock&) = delete;
  MachineLock& operator=(const MachineLock&) = delete;

 private:
  int fd_ = -1;
};

}  // namespace study
