// Listens to a 3D mouse or to the sticks of a gamepad, for whoever wants to know where it is pushed now.
#pragma once

#include <thread>

#include "engine/core/latest_value.hpp"
#include "haptics/devices/hid_link.hpp"
#include "haptics/devices/hid_motion.hpp"

namespace palpate {

/// The last report. A device that is unplugged, or falls silent while it is pushed, pushes no more.
struct HidPush {
  HidMotion motion;  ///< shaped
  bool plugged = true;
};

/// A push or turn, -1 to 1 on each axis, as it should act: nothing up to `deadShare` of the full way, where a worn
/// stick may rest, then progressively up to a length of 1, in the same direction.
DVec3 shaped(const DVec3& push, double deadShare) noexcept;

/// A thread of its own reads. Asking waits for nobody and allocates nothing.
class HidListener {
 public:
  /// `device`: one that chooseHidSteering() gave. `whileGone`: see HidLink. Throws Error where it cannot be opened.
  HidListener(std::shared_ptr<HidTransport> transport, const HidInfo& device, HidRemark remark, std::string whileGone);

  /// For one thread.
  const HidPush& now() noexcept;

 private:
  void listen(const std::stop_token& stop);

  TakeHidReport take_;
  double deadShare_;
  HidLink link_;  // of the thread that listens
  LatestValue<HidPush> latest_;
  HidPush last_;           // of the one who asks
  std::jthread listener_;  // goes first
};

}  // namespace palpate
