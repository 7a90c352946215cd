#include "libstudy/markers/marker_sender.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "libstudy/base/clock.hpp"
#include "libstudy/base/no_signals.hpp"
#include "libstudy/pacing/real_time.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

}  // namespace

MarkerSender::MarkerSender(std::string name, std::unique_ptr<MarkerReceiver> receiver)
    : name_(std::move(name)), receiver_(std::move(receiver)) {
  const NoSignals in_thread;  // a thread inherits the mask
  thread_ = std::thread([this] { work(); });
}

MarkerSender::~MarkerSender() { finish(); }

void MarkerSender::send(const Marker& marker) {
  const std::size_t sent = sent_.load(std::memory_order_relaxed);
  if (sent - done_.load(std::memory_order_acquire) >= capacity) {
    overflow_.push_back(marker);
    return;
  }
  ring_[sent % capacity] = {marker, RealClock().now_ns()};
  sent_.store(sent + 1, std::memory_order_release);
  waiting_.release();
}

void MarkerSender::work() {
  const RealTimeScheduling scheduling;
  for (;;) {
    if (!wait()) {
      receiver_->rest();
      continue;
    }
    const std::size_t done = done_.load(std::memory_order_relaxed);
    if (done == sent_.load(std::memory_order_acquire)) break;  // finish() woke the thread
    write(ring_[done % capacity]);
    done_.store(done + 1, std::memory_order_release);
  }
  if (receiver_->rest_due_ns() == never_ns) return;
  RealClock().wait_until(receiver_->rest_due_ns());
  receiver_->rest();
}

/// Waits for a marker or for finish(). False: the end of a pulse came first.
bool MarkerSender::wait() {
  const std::int64_t rest_ns = receiver_->rest_due_ns();
  if (rest_ns != never_ns) {
    const std::int64_t left_ns = std::max<std::int64_t>(0, rest_ns - RealClock().now_ns());
    return waiting_.try_acquire_for(std::chrono::nanoseconds(left_ns));
  }
  waiting_.acquire();
  return true;
}

void MarkerSender::write(const Queued& queued) {
  const std::int64_t stop_ns = stop_ns_;
  const bool late = stop_ns != 0 && RealClock().now_ns() > stop_ns;
  const std::string lost = late ? "the session had ended" : receiver_->write(queued.marker, queued.queued_ns);
  keep(queued.marker, RealClock().now_ns(), lost);
}

void MarkerSender::keep(const Marker& marker, std::int64_t written_ns, const std::string& lost) {
  const std::scoped_lock lock(mutex_);
  records_.push_back({marker, name_, written_ns, lost});
  if (!lost.empty() && !losing_)
    news_.push_back("markers to " + name_ + " are lost (" + lost + "); the session goes on");
  if (lost.empty() && losing_) news_.push_back("markers to " + name_ + " arrive again");
  losing_ = !lost.empty();
}

void MarkerSender::settle() {
  stop_ns_ = RealClock().now_ns() + second_ns;
  // The last write may have begun just before stop_ns_.
  const std::int64_t until_ns = stop_ns_ + 2 * second_ns;
  while (done_ != sent_ && RealClock().now_ns() < until_ns)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  stop_ns_ = 0;
}

std::vector<MarkerRecord> MarkerSender::take() {
  for (const Marker& marker : std::exchange(overflow_, {})) keep(marker, 0, "the queue was full");
  const std::scoped_lock lock(mutex_);
  return std::exchange(records_, {});
}

std::vector<std::string> MarkerSender::take_news() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(news_, {});
}

void MarkerSender::finish() {
  if (!thread_.joinable()) return;
  settle();
  stop_ns_ = 1;  // in the past: what is queued still is lost
  waiting_.release();
  thread_.join();
}

MarkerSenders::MarkerSenders(const std::vector<std::string>& receivers, const MarkerPulse& pulse) {
  for (std::size_t i = 0; i < receivers.size(); ++i) {
    const std::string& receiver = receivers[i];
    for (std::size_t before = 0; before < i; ++before)
      if (same_marker_receiver(receivers[before], receiver))
        throw base::Error("markers to " + receiver,
                          receivers[before] == receiver
                              ? "are asked for twice"
                              : "go to the same receiver as those to " + receivers[before],
                          "leave one out");
    senders_.push_back(std::make_unique<MarkerSender>(receiver, open_marker_receiver(receiver, pulse)));
  }
}

void MarkerSenders::send(Marker marker) {
  if (senders_.empty()) return;
  marker.utc_ns = utc_ns_of(marker.clock_ns);
  for (const auto& sender : senders_) sender->send(marker);
}

std::vector<MarkerRecord> MarkerSenders::take_settled() {
  for (const auto& sender : senders_) sender->settle();
  return take();
}

std::vector<MarkerRecord> MarkerSenders::take() {
  std::vector<MarkerRecord> all;
  for (const auto& sender : senders_) {
    std::vector<MarkerRecord> some = sender->take();
    all.insert(all.end(), some.begin(), some.end());
  }
  taken_.insert(taken_.end(), all.begin(), all.end());
  return all;
}

std::vector<std::string> MarkerSenders::take_news() {
  std::vector<std::string> all;
  for (const auto& sender : senders_) {
    for (const std::string& news : sender->take_news()) all.push_back(news);
  }
  return all;
}

std::string MarkerSenders::take_summary() { return marker_summary(std::exchange(taken_, {})); }

void MarkerSenders::finish() {
  for (const auto& sender : senders_) sender->finish();
}

}  // namespace study
