#pragma once

#include "engine/motion/cloud_source.hpp"
#include "engine/motion/fused_stream.hpp"

namespace palpate {

/// The newest frame of a depth stream is the cloud: points in metres, in the world of the stream's poses, or in the
/// camera's axes where it has none (makePoints()). No point of one frame is one of the next. Where the stream is taken
/// from it, the last frame stays.
class DepthSource final : public CloudSource {
 public:
  /// `origin`: of the cloud, metres.
  explicit DepthSource(std::shared_ptr<PlayedStream> stream, const DVec3& origin = DVec3(0));

  /// As many as the camera has pixels.
  std::size_t size() const override { return size_; }
  bool keepsPoints() const override { return false; }
  /// Throws Error where no frame of the stream can be read. A time of a recorded stream that is played exactly has the
  /// same points, whatever was asked for before.
  void makeFrame(double time_s, CloudFrame& frame) override;
  bool hasNewer(double time_s, double than_s) override;

 private:
  std::shared_ptr<PlayedStream> stream_;
  std::size_t size_;
  DVec3 origin_;
  std::optional<std::uint64_t> made_;  // serial of the frame that was made last
};

}  // namespace palpate
