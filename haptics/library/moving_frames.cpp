#include "haptics/library/moving_frames.hpp"

#include <chrono>
#include <cmath>
#include <thread>
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

MovingFrames::MovingFrames(const std::optional<pp_frames_options>& options, const Model& model)
    : origin_(model.cloud.origin) {
  if (!options) return;
  const std::size_t most = options->max_points ? options->max_points : model.cloud.size();
  pushed_ = std::make_unique<PushedFrames>(model.cloud, most, options->stable_rows != 0);
}

void MovingFrames::push(PointCloud cloud, std::vector<Vec3> velocities, double time_s) {
  if (!pushed_) throw StateError("this session was not opened for points that move frame by frame");
  CloudFrame frame;
  frame.time_s = time_s;
  frame.positions = std::move(cloud.positions);
  frame.normals = std::move(cloud.normals);
  frame.velocities = std::move(velocities);
  const DVec3 away = cloud.origin - origin_;
  for (Vec3& position : frame.positions) position = Vec3(DVec3(position) + away);
  pushed_->push(std::move(frame));
}

bool MovingFrames::take(Session& session) {
  CloudFrame taken;
  FrameStream* const frames = session.backend().frames();
  if (!frames || !frames->take(taken)) return false;
  auto frame = std::make_shared<FrameObject>();
  frame->cloud.origin = origin_;
  frame->cloud.positions = std::move(taken.positions);
  frame->cloud.normals = std::move(taken.normals);
  frame->velocities = std::move(taken.velocities);
  frame->velocities.resize(frame->cloud.size(), Vec3(0));
  frame->moving = frame->cloud.size() - session.model().standing();
  frame->time_s = taken.time_s;
  newest_ = std::move(frame);
  return true;
}

std::shared_ptr<const FrameObject> MovingFrames::newest(Session& session, bool isLive) {
  if (!newest_) {
    const PointCloud& cloud = session.model().cloud;
    auto first = std::make_shared<FrameObject>();
    first->cloud.origin = cloud.origin;
    first->cloud.positions = cloud.positions;
    first->cloud.normals = cloud.normals;
    first->velocities.assign(cloud.size(), Vec3(0));
    first->moving = cloud.size() - session.model().standing();
    newest_ = std::move(first);
  }
  take(session);
  if (!isLive) return newest_;
  // The frame that was ready may be as old as the last request.
  const auto end = std::chrono::steady_clock::now() + std::chrono::milliseconds(50);
  while (!take(session) && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return newest_;
}

void MovingFrames::restart() {
  if (pushed_) pushed_->restart();
}

void MovingFrames::endLive(Session& session) {
  if (!pushed_ || !std::exchange(isLive_, false)) return;
  session.backend().finish();  // frames in progress are for the old time and would include new frames
  pushed_->restart();          // the next path begins at 0
}

}  // namespace palpate::library
