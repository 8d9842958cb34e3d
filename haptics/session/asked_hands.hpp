// Hands whose servo loop is another program's: it asks for each tick itself.
#pragma once

#include <exception>
#include <optional>
#include <span>
#include <vector>

#include "haptics/force_gate.hpp"
#include "haptics/force_law.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

/// What one tick came to for a hand.
struct AskedTick {
  Contact contact;
  DVec3 force_N{0};
  DVec3 torque_mNm{0};        ///< of a tool of many points, about the HIP
  double penetration_mm = 0;  ///< from HIP to proxy; 0 where nothing is touched
};

struct AskedHandsOptions {
  double budget_us = 0;  ///< that an answer may take before the last one bridges it; 0: as long as it takes
  CustomForce law;       ///< the first hand's, in place of spring and damper
};

/// Gives the forces of each tick's poses as a Session would, within the limits of its force law; what protects a person
/// from a device (ForceGate, Passivity) is the affair of whoever has the devices. The session and this belong to one
/// thread, and nothing else runs the session meanwhile. With a budget edits wait until somebody calls
/// EditRelay::catchUp(), on any one thread; without one they are taken in between ticks. Where others feel the model,
/// too, they see the first hand, and while their server is silent the force fades (InformationAge); when it is heard
/// again the force comes back as at the start of a session in the hand (ForceGate).
class AskedHands {
 public:
  /// As many as the session has. It outlives them. They touch nothing yet.
  AskedHands(Session& session, const AskedHandsOptions& options);

  std::size_t count() const { return hands_.size(); }
  /// A pose for each hand, all of the same time; the answers stand until the next call. Allocates nothing while nothing
  /// is edited. On any fault the force is zero and the contact not valid.
  std::span<const AskedTick> tick(std::span<const Pose> poses) noexcept;
  /// All were lifted, and are put down elsewhere with the next poses.
  void lift() noexcept;
  /// Throws what went wrong while edits were taken in.
  void check() const;

 private:
  void tellOthers(std::span<const Pose> poses) noexcept;
  void feel(std::size_t hand, const Contact& answer, const Pose& pose, double dt_s) noexcept;
  void holdBack(std::size_t hand, double dt_s) noexcept;

  Session& session_;
  double budget_us_;
  std::vector<ForceLaw> laws_;  // one for each hand, as these
  std::vector<AskedTick> hands_;
  std::vector<ForceGate> gates_;  // where what is felt may not be true any more
  TickObserver takesEdits_;
  std::optional<double> lastTime_s_;
  std::exception_ptr failure_;
};

}  // namespace palpate
