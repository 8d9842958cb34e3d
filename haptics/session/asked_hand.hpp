// A hand whose servo loop is another program's: it asks for each tick itself.
#pragma once

#include <exception>
#include <optional>

#include "haptics/force_law.hpp"
#include "haptics/session/session.hpp"

namespace palpate {

/// What one tick came to.
struct AskedTick {
  Contact contact;
  DVec3 force_N{0};
  double penetration_mm = 0;  ///< from HIP to proxy; 0 where nothing is touched
};

struct AskedHandOptions {
  double budget_us = 0;  ///< that an answer may take before the last one bridges it; 0: as long as it takes
  CustomForce law;       ///< in place of spring and damper
};

/// Gives the force of each pose as a Session would, within the limits of its force law; what protects a person from a
/// device (ForceGate, Passivity) is the affair of whoever has the device. The session and this belong to one thread,
/// and nothing else runs the session meanwhile. With a budget edits wait until somebody calls EditRelay::catchUp(), on any
/// one thread; without one they are taken in between ticks.
class AskedHand {
 public:
  /// The session outlives it. The hand touches nothing yet.
  AskedHand(Session& session, const AskedHandOptions& options);

  /// Allocates nothing while nothing is edited. On any fault the force is zero and the contact not valid.
  AskedTick tick(const Pose& pose) noexcept;
  /// It was lifted, and is put down elsewhere with the next pose.
  void lift() noexcept;
  /// Throws what went wrong while edits were taken in.
  void check() const;

 private:
  Session& session_;
  double budget_us_;
  ForceLaw law_;
  TickObserver takesEdits_;
  std::optional<double> lastTime_s_;
  std::exception_ptr failure_;
};

}  // namespace palpate
