// Who looks at a cloud that several have, and from where.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/camera_frustum.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// A camera that shows a picture. Coordinates of the file.
struct CameraPlace {
  DVec3 position{0};
  DQuat turn{1, 0, 0, 0};  ///< unit, of its axes: x to the right of the picture, y down in it, z where it looks
  double fovY_rad = 0;     ///< vertical
  double aspect = 1;       ///< width / height of the picture

  bool operator==(const CameraPlace&) const = default;
};
/// Whether it is one that a picture can have: finite, with a unit turn, and an angle and an aspect that are of a
/// picture.
bool isCamera(const CameraPlace& camera);
CameraFrustum frustumOf(const CameraPlace& camera);

/// Somebody else's camera, as it was heard last.
struct SeenCamera {
  std::string name;          ///< of the hand that it belongs to
  std::uint32_t number = 0;  ///< that hand's (SeenHand::number)
  CameraPlace place;
  double age_s = 0;
};

/// The cameras of a session that several have. For any thread.
class SharedCameras {
 public:
  virtual ~SharedCameras() = default;
  /// From where this program's picture is seen; nothing: nobody is told, as at first.
  virtual void show(const std::optional<CameraPlace>& camera) = 0;
  /// Those that were heard within the last seconds.
  virtual std::vector<SeenCamera> others() const = 0;
};

}  // namespace palpate
