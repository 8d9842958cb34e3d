#pragma once

namespace palpate {

class Device;
class EditLog;
class FramePipeline;

/// The points of a back end on a GPU, for a picture that is drawn there.
class GpuPoints {
 public:
  virtual ~GpuPoints() = default;
  /// The log of the edits, if they are on the GPU `sight`; else null.
  virtual EditLog* editLogOn(const Device& sight) = 0;
  /// The pipeline that brings the frames of a source to the GPU `sight`; null if there is none on that GPU.
  virtual FramePipeline* framesOn(const Device& sight) = 0;
};

}  // namespace palpate
