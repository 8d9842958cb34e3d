// Who else hears from where the window's picture is seen.
#pragma once

#include <memory>

#include "apps/view/session.hpp"
#include "engine/render/camera.hpp"
#include "haptics/shared_presence.hpp"

namespace palpate {

class RosCamera;

/// As others see it; `origin`: of the cloud whose coordinates the camera is in.
CameraPlace placeOf(const Camera& camera, const DVec3& origin, double aspect);

/// Those who have joined the same session, unless the window hides it from them, and programs of ROS.
class OwnCamera {
 public:
  /// Throws UsageError and NetworkError of ROS.
  explicit OwnCamera(const WindowOptions& options);
  ~OwnCamera();
  OwnCamera(const OwnCamera&) = delete;
  OwnCamera& operator=(const OwnCamera&) = delete;

  /// Once for each picture. Throws NetworkError where programs of ROS hear nothing from now on.
  void follow(const WindowSession& session, const Camera& camera, const UVec2& size_px);

 private:
  bool isHidden_;
  std::unique_ptr<RosCamera> ros_;
};

}  // namespace palpate
