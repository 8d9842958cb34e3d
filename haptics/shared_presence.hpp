// The participants of a shared cloud: their hands and their cameras.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/camera_frustum.hpp"
#include "engine/core/contact_query.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Position of a hand. Coordinates of the file.
struct HandPlace {
  DVec3 position{0};  ///< of the HIP
  DVec3 proxy{0};     ///< of the proxy; `position` if nothing is touched
  bool touching = false, sculpts = false;
  bool operator==(const HandPlace&) const = default;
};

/// The hands of one program, at the same time.
struct HandPlaces {
  std::uint32_t count = 0;  ///< at most kMaxHands
  std::array<HandPlace, kMaxHands> hands{};
};

/// Another client's hand, as last received.
struct SeenHand {
  std::string name;
  std::uint32_t number = 0;  ///< the same on all machines, while the hand takes part
  HandPlace place;
  double age_s = 0;
  DVec3 force_N{0};  ///< force of the water or sand that this program simulates on its ball
};

/// Camera of a picture. Coordinates of the file.
struct CameraPlace {
  DVec3 position{0};
  DQuat turn{1, 0, 0, 0};  ///< unit quaternion of its axes: x right in the picture, y down, z along the view
  double fovY_rad = 0;     ///< vertical
  double aspect = 1;       ///< width / height of the picture

  bool operator==(const CameraPlace&) const = default;
};
/// Whether the camera is valid: finite, with a unit rotation, and with a possible angle and aspect.
bool isCamera(const CameraPlace& camera);
CameraFrustum frustumOf(const CameraPlace& camera);

/// Another client's camera, as last received.
struct SeenCamera {
  std::string name;          ///< of its hand
  std::uint32_t number = 0;  ///< that hand's (SeenHand::number)
  CameraPlace place;
  double age_s = 0;
};

/// Hands and cameras of a shared session. Thread-safe, unless stated otherwise.
class SharedPresence {
 public:
  virtual ~SharedPresence() = default;
  /// Positions of this program's hands. For the thread that answers them, one at a time: never blocks. Hands are shown
  /// for another second after their last update.
  virtual void moved(const HandPlaces& hands) noexcept = 0;
  /// Camera of this program's picture; nothing: not published, as initially. Throws UsageError for an invalid camera.
  virtual void show(const std::optional<CameraPlace>& camera) = 0;
  /// Those of others received within the last seconds.
  virtual std::vector<SeenHand> hands() const = 0;
  virtual std::vector<SeenCamera> cameras() const = 0;
};

}  // namespace palpate
