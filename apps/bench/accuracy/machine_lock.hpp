#pragma once
/// Timed runs one after the other: runs beside each other on one machine disturb each other's times.

namespace apps {

/// The machine's lock for timed runs, whoever's they are: flock() on the file vip-bench.lock in
/// $VIP_LOCK_DIR, else in /run/lock, else in /tmp, of which the first is taken that every user may write to.
/// The constructor waits for it; a run that waits says so on stderr once a program. It goes with the object,
/// and with a program that is killed. base::Error where no such folder is, or where the file cannot be
/// opened.
class MachineLock {
 public:
  MachineLock();
  ~MachineLock();
  MachineLock(const MachineLock&) = delete;
  MachineLock& operator=(const MachineLock&) = delete;

 private:
  int fd_ = -1;
};

}  // namespace apps
