#include "engine/motion/depth_read_ahead.hpp"

#include <exception>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/start_thread.hpp"

namespace palpate {

namespace {

constexpr std::size_t kQueue = 4;  // frames: bridges disk delays of up to a tenth of a second

}  // namespace

DepthReadAhead::DepthReadAhead(std::shared_ptr<DepthStream> stream, bool loops)
    : stream_(std::move(stream)), isRecorded_(stream_->isRecorded()), loops_(loops && isRecorded_) {}

DepthReadAhead::~DepthReadAhead() {
  {
    const std::scoped_lock lock(mutex_);
    stops_ = true;
  }
  stream_->stop();
  changed_.notify_all();
}

void DepthReadAhead::serve() {
  Lock lock(mutex_);
  while (waitForRoom(lock)) {
    try {
      readOne(lock);
    } catch (const Error& error) {
      if (!lock.owns_lock()) lock.lock();
      ++counts_.lost;
      counts_.lastLoss = error.what();
    } catch (const std::exception& error) {  // out of memory: the following frames would fail as well
      if (!lock.owns_lock()) lock.lock();
      counts_.lastLoss = error.what();
      counts_.ended = true;
    }
    changed_.notify_all();
  }
}

// False: the thread is to stop.
bool DepthReadAhead::waitForRoom(Lock& lock) {
  changed_.wait(lock,
                [&] { return stops_ || restarts_ || (!counts_.ended && (queue_.size() < kQueue || !isRecorded_)); });
  if (stops_) return false;
  if (std::exchange(restarts_, false)) stream_->rewind();
  return true;
}

void DepthReadAhead::readOne(Lock& lock) {
  DepthFrame frame;
  if (!spares_.empty()) {
    frame = std::move(spares_.back());
    spares_.pop_back();
  }
  const bool mayBeLate = late_ && late_->pass == pass_;
  const double late_s = mayBeLate ? late_->time_s : 0;
  lock.unlock();
  const std::uint64_t skipped = mayBeLate ? stream_->skipTo(late_s) : 0;
  const bool isThere = stream_->next(frame);
  lock.lock();
  if (restarts_) {
    spares_.push_back(std::move(frame));
    return;
  }
  counts_.dropped += skipped;
  if (isThere)
    keep(std::move(frame));
  else
    endPass();
}

void DepthReadAhead::keep(DepthFrame frame) {
  const Place place{.pass = pass_, .time_s = frame.time_s, .isFirst = readInPass_++ == 0};
  queue_.push_back({.frame = std::move(frame), .place = place});
  if (isRecorded_ || queue_.size() <= kQueue) return;
  spares_.push_back(std::move(queue_.front().frame));
  queue_.pop_front();
  ++counts_.dropped;
}

void DepthReadAhead::endPass() {
  counts_.ended = !loops_ || readInPass_ == 0;
  if (counts_.ended) return;
  stream_->rewind();
  ++pass_;
  readInPass_ = 0;
}

bool DepthReadAhead::waitForFrame(Lock& lock, bool waits) {
  if (!thread_.joinable()) thread_ = startThread([this] { serve(); });
  if (waits) changed_.wait(lock, [&] { return !queue_.empty() || (counts_.ended && !restarts_); });
  return !queue_.empty();
}

std::optional<DepthReadAhead::Place> DepthReadAhead::peek(bool waits) {
  Lock lock(mutex_);
  if (!waitForFrame(lock, waits)) return std::nullopt;
  return queue_.front().place;
}

bool DepthReadAhead::take(DepthFrame& frame, bool waits) {
  Lock lock(mutex_);
  if (!waitForFrame(lock, waits)) return false;
  std::swap(frame, queue_.front().frame);
  spares_.push_back(std::move(queue_.front().frame));
  queue_.pop_front();
  changed_.notify_all();
  return true;
}

void DepthReadAhead::restart(std::uint64_t pass) {
  const std::scoped_lock lock(mutex_);
  for (Read& read : queue_) spares_.push_back(std::move(read.frame));
  queue_.clear();
  pass_ = pass;
  readInPass_ = 0;
  late_.reset();
  restarts_ = true;
  counts_.ended = false;
  changed_.notify_all();
}

void DepthReadAhead::passOver(std::uint64_t pass, double time_s) {
  const std::scoped_lock lock(mutex_);
  late_ = Place{.pass = pass, .time_s = time_s, .isFirst = false};
}

std::uint64_t DepthReadAhead::pass() const {
  const std::scoped_lock lock(mutex_);
  return pass_;
}

DepthReadAhead::Counts DepthReadAhead::counts() const {
  const std::scoped_lock lock(mutex_);
  return counts_;
}

}  // namespace palpate
