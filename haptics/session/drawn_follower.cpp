#include "haptics/session/drawn_follower.hpp"

#include <algorithm>

#include "engine/touch/frame_pipeline.hpp"
#include "engine/touch/gpu_points.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

DrawnFollower::DrawnFollower(Device& sight, const Model& model, TouchBackend& backend)
    : frameStream_(backend.frames()) {
  // Minimum room for new points if their number is unlimited.
  constexpr std::size_t kMinNew = 1 << 16;
  const EditScope scope = backend.report().scope;
  const auto most = static_cast<std::uint32_t>(std::max(kMinNew, model.cloud.size()));
  drawn_.emplace(sight, model.cloud,
                 DrawnOptions{.spare = scope.newPoints.value_or(most),
                              .painted = scope.paints,
                              .spacing = model.spacingOfDiscs(),
                              .edited = scope.edits});
  GpuPoints* const points = backend.gpuPoints();
  if (!points) return;
  sameGpu_ = points->framesOn(sight);
  if (EditLog* const log = points->editLogOn(sight)) reader_.emplace(*log);
}

void DrawnFollower::followFrames() {
  if (sameGpu_) {
    frames_ += sameGpu_->read([&](const FramePipeline::Placed& placed) {
      drawn_->place(placed.half, sameGpu_->slots(), placed.colored);
      framePoints_ = placed.points;
    });
    return;
  }
  CloudFrame frame;
  if (!frameStream_ || !frameStream_->take(frame)) return;
  drawn_->place(frame);
  framePoints_ = frame.size();
  ++frames_;
}

void DrawnFollower::catchUp(const EditBatch& batch) {
  try {
    followFrames();
    if (reader_) drawn_->catchUp(*reader_);
    if (!reader_ || batch.hasMoreThanLog) drawn_->catchUp(batch.points);
    drawn_->attributes().follow(batch.attributes);
  } catch (...) {
    reader_.reset();  // or the back end would wait for this reader forever
    throw;
  }
}

}  // namespace palpate
