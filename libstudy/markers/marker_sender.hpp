#pragma once
/// Sends markers to receivers without delaying the session: each receiver has a thread and a bounded queue.

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <semaphore>
#include <string>
#include <thread>
#include <vector>

#include "libstudy/markers/receiver.hpp"

namespace study {

/// The thread of one receiver. send() may be called from one thread alone, take() and take_news() from any.
class MarkerSender {
 public:
  /// Markers that wait for the receiver; a further one is lost.
  static constexpr std::size_t capacity = 1024;

  /// name: the receiver as --markers names it.
  MarkerSender(std::string name, std::unique_ptr<MarkerReceiver> receiver);
  /// As finish().
  ~MarkerSender();
  MarkerSender(const MarkerSender&) = delete;
  MarkerSender& operator=(const MarkerSender&) = delete;

  /// Queues a marker. Never waits for the receiver and takes no lock.
  void send(const Marker& marker);
  /// Gives the queue one more second and counts the rest as lost. Then nothing is queued.
  void settle();
  /// What became of the markers since the last call.
  std::vector<MarkerRecord> take();
  /// Lines for the experimenter: when markers begin to be lost, and when they arrive again.
  std::vector<std::string> take_news();
  /// settle(), and the end of the thread.
  void finish();

 private:
  struct Queued {
    Marker marker;
    std::int64_t queued_ns = 0;
  };

  void work();
  bool wait();
  void write(const Queued& queued);
  void keep(const Marker& marker, std::int64_t written_ns, const std::string& lost);

  std::string name_;
  std::unique_ptr<MarkerReceiver> receiver_;
  std::array<Queued, capacity> ring_{};
  std::atomic<std::size_t> sent_ = 0, done_ = 0;
  std::vector<Marker> overflow_;  ///< markers that found the queue full; the session's thread only
  std::counting_semaphore<> waiting_{0};
  std::atomic<std::int64_t> stop_ns_ = 0;  ///< 0: running; else nothing is written after this time
  std::mutex mutex_;                       ///< guards the following members
  std::vector<MarkerRecord> records_;
  std::vector<std::string> news_;
  bool losing_ = false;
  std::thread thread_;
};

/// All receivers of a session.
class MarkerSenders {
 public:
  /// Opens each receiver (open_marker_receiver()). base::Error if one cannot be reached.
  MarkerSenders(const std::vector<std::string>& receivers, const MarkerPulse& pulse);
  bool empty() const { return senders_.empty(); }
  /// Sets Marker::utc_ns and sends the marker to all receivers.
  void send(Marker marker);
  /// The records since the last call, after MarkerSender::settle(): of all markers that were sent.
  std::vector<MarkerRecord> take_settled();
  std::vector<MarkerRecord> take();
  std::vector<std::string> take_news();
  /// marker_summary() of the records that take() returned since the last call.
  std::string take_summary();
  /// MarkerSender::finish() for all.
  void finish();

 private:
  std::vector<MarkerRecord> taken_;
  std::vector<std::unique_ptr<MarkerSender>> senders_;
};

}  // namespace study
