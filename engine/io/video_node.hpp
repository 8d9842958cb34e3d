// What a video device of Linux is asked, so that tests can answer in the place of a camera.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "engine/io/depth_camera.hpp"

namespace palpate {

/// An open device. Functions that return an int return a number of errno, 0 where all went well.
class VideoNode {
 public:
  virtual ~VideoNode() = default;
  /// One of <linux/videodev2.h>'s.
  virtual int control(unsigned long request, void* argument) noexcept = 0;
  virtual int map(std::size_t bytes, std::int64_t offset, std::span<const std::byte>& memory) noexcept = 0;
  virtual void unmap(std::span<const std::byte> memory) noexcept = 0;
  /// Until there is a frame, or something went wrong with the device, or wake() was called.
  virtual int wait() noexcept = 0;
  /// Ends a wait, and all that come. From any thread.
  virtual void wake() noexcept = 0;
};

/// Streams the frames of a node. As openDepthCamera().
std::shared_ptr<DepthStream> streamVideoNode(std::unique_ptr<VideoNode> node, const std::string& name,
                                             const CameraText& camera);

}  // namespace palpate
