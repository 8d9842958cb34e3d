// Hands whose servo loop belongs to the calling program, which asks for each tick.
#pragma once

#include <exception>
#include <optional>
#include <span>
#include <vector>

#include "haptics/force_gate.hpp"
#include "haptics/force_law.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

/// Result of one tick for a hand.
struct AskedTick {
  Contact contact;
  DVec3 force_N{0};
  DVec3 torque_mNm{0};        ///< of a tool with many points, about the HIP
  double penetration_mm = 0;  ///< from HIP to proxy; 0 without contact
};

struct AskedHandsOptions {
  double budget_us = 0;  ///< maximum time of an answer, after which the last one bridges it; 0: unlimited
  CustomForce law;       ///< of the first hand, in place of spring and damper
};

/// Returns the forces of each tick's poses as a Session would, within the limits of its force law; the protection of a
/// person from a device (ForceGate, Passivity) is the caller's task. The session and this object belong to one thread,
/// and nothing else runs the session meanwhile. With a budget, edits are kept until any one thread calls
/// EditRelay::catchUp(); without one they are taken between ticks. In a shared model the others see the first hand.
/// While its server is silent the force fades (InformationAge); once it is heard again, the force returns as at the
/// start of a session with a held device (ForceGate).
class AskedHands {
 public:
  /// As many hands as the session has, initially without contact. The session must outlive them.
  AskedHands(Session& session, const AskedHandsOptions& options);

  std::size_t count() const { return hands_.size(); }
  /// Takes a pose for each hand, all of the same time; the result is valid until the next call. Allocates nothing
  /// unless points are edited. On any fault the force is zero and the contact invalid.
  std::span<const AskedTick> tick(std::span<const Pose> poses) noexcept;
  /// Lifts all hands; the next poses put them down elsewhere.
  void lift() noexcept;
  /// Throws the failure of taking edits, if there was one.
  void check() const;

 private:
  void tellOthers(std::span<const Pose> poses) noexcept;
  void feel(std::size_t hand, const Contact& answer, const Pose& pose, double dt_s) noexcept;
  void holdBack(std::size_t hand, double dt_s) noexcept;

  Session& session_;
  double budget_us_;
  std::vector<ForceLaw> laws_;  // one for each hand, as in the next two
  std::vector<AskedTick> hands_;
  std::vector<ForceGate> gates_;  // if the information about the surface may be old
  TickObserver takesEdits_;
  std::optional<double> lastTime_s_;
  std::exception_ptr failure_;
};

}  // namespace palpate
