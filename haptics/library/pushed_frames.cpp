#include "haptics/library/pushed_frames.hpp"

#include <cmath>
#include <utility>

#include "haptics/library/failures.hpp"

namespace palpate::library {

PushedFrames::PushedFrames(const PointCloud& first, std::size_t most, bool keeps) : most_(most), keeps_(keeps) {
  if (most < first.size())
    throw UsageError("max_points: {} are fewer than the {} of the first frame", most, first.size());
  CloudFrame frame;
  frame.positions = first.positions;
  frame.normals = first.normals;
  frames_.push_back(std::move(frame));
}

std::size_t PushedFrames::at(double time_s) const {
  std::size_t newest = 0;
  while (newest + 1 < frames_.size() && frames_[newest + 1].time_s <= time_s) ++newest;
  return newest;
}

void PushedFrames::makeFrame(double time_s, CloudFrame& frame) {
  const std::scoped_lock hold(lock_);
  frames_.erase(frames_.begin(), frames_.begin() + static_cast<std::ptrdiff_t>(at(time_s)));
  frame = frames_.front();
}

bool PushedFrames::hasNewer(double time_s, double than_s) {
  const std::scoped_lock hold(lock_);
  return frames_[at(time_s)].time_s != than_s;
}

void PushedFrames::push(CloudFrame frame) {
  if (!std::isfinite(frame.time_s)) throw UsageError("t_s: {} is not a finite number", frame.time_s);
  try {
    requireWhole(frame, most_);
  } catch (const Error& error) {
    throw UsageError("{}", error.what());
  }
  const std::scoped_lock hold(lock_);
  if (keeps_ && frame.size() != frames_.back().size())
    throw UsageError("count: a frame of {} points follows one of {}, and stable_rows is set", frame.size(),
                     frames_.back().size());
  if (!(frame.time_s > frames_.back().time_s))
    throw UsageError("t_s: {} s is not after the frame before it, of {} s", frame.time_s, frames_.back().time_s);
  // While nothing touches, no time passes: the frame in use is the first, and the next one would be the first dropped.
  if (frames_.size() > kMaxPending) frames_.erase(frames_.begin() + 1);
  frames_.push_back(std::move(frame));
}

void PushedFrames::restart() {
  const std::scoped_lock hold(lock_);
  frames_.erase(frames_.begin(), frames_.end() - 1);
  frames_.front().time_s = 0;
}

}  // namespace palpate::library
