// Who takes part in a cloud that several have: where the hands are, and from where it is looked at.
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

/// Where a hand is. Coordinates of the file.
struct HandPlace {
  DVec3 position{0};  ///< of what it touches with
  DVec3 proxy{0};     ///< where the surface holds that; `position` where nothing is touched
  bool touching = false, sculpts = false;
  bool operator==(const HandPlace&) const = default;
};

/// Those of one program, at the same moment.
struct HandPlaces {
  std::uint32_t count = 0;  ///< at most kMaxHands
  std::array<HandPlace, kMaxHands> hands{};
};

/// Somebody else's hand, as it was heard last.
struct SeenHand {
  std::string name;
  std::uint32_t number = 0;  ///< the same on all machines, for as long as the hand takes part
  HandPlace place;
  double age_s = 0;
};

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

/// The hands and cameras of a session that several have. For any thread, but for what says otherwise.
class SharedPresence {
 public:
  virtual ~SharedPresence() = default;
  /// Where this program's hands are. For the thread that answers them, one at a time: waits for nobody. Hands of which
  /// nothing more is said are shown for a second more.
  virtual void moved(const HandPlaces& hands) noexcept = 0;
  /// From where this program's picture is seen; nothing: nobody is told, as at first. Throws UsageError for a camera
  /// that is none.
  virtual void show(const std::optional<CameraPlace>& camera) = 0;
  /// Those of others that were heard within the last seconds.
  virtual std::vector<SeenHand> hands() const = 0;
  virtual std::vector<SeenCamera> cameras() const = 0;
};

}  // namespace palpate
