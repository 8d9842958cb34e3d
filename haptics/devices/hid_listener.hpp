// Listens to a 3D mouse or to the sticks of a gamepad, and provides their current push.
#pragma once

#include <thread>

#include "engine/core/latest_value.hpp"
#include "haptics/devices/hid_link.hpp"
#include "haptics/devices/hid_motion.hpp"

namespace palpate {

/// The last report. A device that is unplugged, or falls silent while it is pushed, counts as released.
struct HidPush {
  HidMotion motion;  ///< shaped
  bool plugged = true;
};

/// Response to a push or rotation, -1 to 1 on each axis: zero up to `deadShare` of the full deflection, where a worn
/// stick may rest, then progressive up to a length of 1, in the same direction.
DVec3 shaped(const DVec3& push, double deadShare) noexcept;

/// A thread of its own reads. now() neither blocks nor allocates.
class HidListener {
 public:
  /// `device`: from chooseHidSteering(). `whileGone`: see HidLink. Throws Error if it cannot be opened.
  HidListener(std::shared_ptr<HidTransport> transport, const HidInfo& device, HidRemark remark, std::string whileGone);

  /// Not thread-safe.
  const HidPush& now() noexcept;

 private:
  void listen(const std::stop_token& stop);

  TakeHidReport take_;
  double deadShare_;
  HidLink link_;  // used by the thread that listens
  LatestValue<HidPush> latest_;
  HidPush last_;           // used by the caller of now()
  std::jthread listener_;  // destroyed first
};

}  // namespace palpate
