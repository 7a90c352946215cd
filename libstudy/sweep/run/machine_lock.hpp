#pragma once
/// A lock by which timed runs follow one another, since parallel runs on one machine distort each other's
/// times.

namespace study {

/// Holds the machine's lock for timed runs of all users while the object exists. The lock is flock() on the
/// file vip-bench.lock in the folder $VIP_LOCK_DIR. If this variable is unset or empty, the folder is the
/// first of /run/lock and /tmp that every user may write to. The constructor waits until the lock is free.
/// The first time that a process waits, it prints a message on stderr. The lock is also released if the
/// program is killed. base::Error without such a folder, or if the file cannot be opened or locked.
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
