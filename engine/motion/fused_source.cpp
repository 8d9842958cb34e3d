#include "engine/motion/fused_source.hpp"

#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

FusedSource::FusedSource(std::shared_ptr<DepthStream> stream, const FusionOptions& options, const IcpOptions& icp, Log* log)
    : stream_(std::move(stream)), fusion_(options, icp, log) {}

bool FusedSource::readNext() {
  while (!hasNext_ && !ended_) {
    try {
      hasNext_ = stream_->next(next_);
      ended_ = !hasNext_;
    } catch (const Error& error) {
      fusion_.countLost(error.what());
    }
  }
  return hasNext_;
}

void FusedSource::fuseNext() {
  hasNext_ = false;
  fusion_.fuse(stream_->camera(), next_);
  time_s_ = next_.time_s;
  const std::scoped_lock lock(mutex_);
  view_.reset();
  if (next_.pose) view_ = {.frustum = frustumOf(stream_->camera(), *next_.pose), .number = next_.number};
}

std::optional<PlayedView> FusedSource::playedView() const {
  const std::scoped_lock lock(mutex_);
  return view_;
}

void FusedSource::rewind() {
  stream_->rewind();
  fusion_.clear();
  hasNext_ = ended_ = false;
  time_s_ = 0;
}

bool FusedSource::hasNewer(double time_s, double than_s) {
  return time_s < than_s || (readNext() && next_.time_s <= time_s);
}

void FusedSource::makeFrame(double time_s, CloudFrame& frame) {
  if (time_s < time_s_) rewind();
  while (readNext() && next_.time_s <= time_s) fuseNext();
  fusion_.map().show(frame);
  frame.time_s = time_s_;
}

}  // namespace palpate
