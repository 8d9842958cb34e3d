// Picture of a session's points, drawn from a copy of them on the GPU that shows it.
#pragma once

#include <memory>
#include <optional>

#include "engine/edit/edit_log.hpp"
#include "engine/render/drawn_cloud.hpp"
#include "haptics/session/edit_relay.hpp"
#include "haptics/session/model.hpp"

namespace palpate {

class FramePipeline;
class FrameStream;

class DrawnFollower final : public EditFollower {
 public:
  /// Follows the edit log of a back end on the same GPU, else the batches of the relay; if a source moves the points,
  /// its newest complete frame, in the live cloud or through the host. All arguments must outlive this object.
  DrawnFollower(Device& sight, const Model& model, TouchBackend& backend);

  void catchUp(const EditBatch& batch) override;
  DrawnCloud& drawn() { return *drawn_; }
  /// Complete frames taken so far, if a source moves the points.
  std::uint64_t frames() const { return frames_; }
  /// Points of the last one.
  std::uint64_t framePoints() const { return framePoints_; }

 private:
  void followFrames();

  FrameStream* frameStream_;          // null: no source moves the points
  FramePipeline* sameGpu_ = nullptr;  // of a back end on the same GPU
  std::optional<DrawnCloud> drawn_;
  std::optional<EditLog::Reader> reader_;  // of a back end on the same GPU
  std::uint64_t frames_ = 0, framePoints_ = 0;
};

}  // namespace palpate
