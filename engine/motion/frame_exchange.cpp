#include "engine/motion/frame_exchange.hpp"

#include <mutex>

namespace palpate {

bool FrameExchange::beginWriting(std::uint32_t half) {
  const std::scoped_lock lock(mutex_);
  if (reading_ == half) return false;
  if (newest_ && newest_->half == half) newest_.reset();
  return true;
}

void FrameExchange::publish(std::uint32_t half, double time_s) {
  const std::scoped_lock lock(mutex_);
  newest_ = {.half = half, .time_s = time_s, .number = ++published_};
}

bool FrameExchange::read(const std::function<void(const Frame&)>& read) {
  Frame frame;
  {
    const std::scoped_lock lock(mutex_);
    if (!newest_ || newest_->number == lastRead_) return false;
    frame = *newest_;
    reading_ = frame.half;
  }
  struct Release {
    FrameExchange& exchange;
    ~Release() {
      const std::scoped_lock lock(exchange.mutex_);
      exchange.reading_.reset();
    }
  } const release{*this};
  read(frame);
  lastRead_ = frame.number;
  return true;
}

}  // namespace palpate
