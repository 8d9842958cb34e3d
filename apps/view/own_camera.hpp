// Publishes the window's camera.
#pragma once

#include <memory>

#include "apps/view/session.hpp"
#include "engine/render/camera.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

class RosCamera;

/// Camera pose as published; `origin`: origin of the cloud whose coordinates the camera uses.
CameraPlace placeOf(const Camera& camera, const DVec3& origin, double aspect);

/// Publishes the camera to the participants of the joined session, unless the window hides it, and to ROS programs.
class OwnCamera {
 public:
  /// Throws UsageError and NetworkError of the ROS publisher.
  explicit OwnCamera(const WindowOptions& options);
  ~OwnCamera();
  OwnCamera(const OwnCamera&) = delete;
  OwnCamera& operator=(const OwnCamera&) = delete;

  /// Called once per frame. Throws NetworkError where publishing to ROS has failed; it stops then.
  void follow(const WindowSession& session, const Camera& camera, const UVec2& size_px);

 private:
  bool isHidden_;
  std::unique_ptr<RosCamera> ros_;
};

}  // namespace palpate
