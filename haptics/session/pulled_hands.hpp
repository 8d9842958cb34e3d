// Hands whose servo loop belongs to the calling program, which asks for each tick.
#pragma once

#include <exception>
#include <optional>
#include <span>
#include <vector>

#include "engine/touch/touch_backend.hpp"
#include "haptics/hand_force.hpp"
#include "haptics/session/hand_publisher.hpp"
#include "haptics/session/session_config.hpp"

namespace palpate {

/// Result of one tick for a hand.
struct PulledTick {
  Contact contact;
  DVec3 force_N{0};
  DVec3 torque_mNm{0};        ///< of a tool with many points, about the HIP
  double penetration_mm = 0;  ///< from HIP to proxy; 0 without contact
  bool withheld = false;      ///< HandForce::isWithheld()
};

struct PullOptions {
  /// Maximum time of an answer, after which the last one bridges it, and edits are kept until they are taken; 0:
  /// unlimited, and edits are taken between ticks.
  double budget_us = 0;
  CustomForce law;  ///< of the first hand, in place of spring and damper
};

/// What a pulled session continues from on another back end of the same points.
struct PulledState {
  PullOptions options;
  std::vector<HandForce> forces;              // one for each hand
  std::vector<ProxyTracker::State> contacts;  // TouchBackend::contacts()
  std::optional<double> lastTime_s;
};

/// The spring by which a hand with this law presses on a surface that yields.
HandSpring springOf(const ForceLaw& law);

/// What pulled hands touch; all references and pointees must outlive them.
struct PulledParts {
  TouchBackend& backend;
  const SessionConfig& config;
  ModelScale scale;
  const InformationAge* known = nullptr;  ///< age of the information about the surface; null: always current
  HandPublisher others;
  TickObserver takesEdits;  ///< after each tick; empty: edits are kept
};

/// Returns the forces of each tick's poses as a run would, within the limits of its force law; the protection of a
/// person from a device (ForceGate, Passivity) is the caller's task. While the server of a shared model is silent the
/// force fades (InformationAge); once it is heard again, the force returns as at the start of a session with a held
/// device (ForceGate). For one thread.
class PulledHands {
 public:
  /// As many hands as the back end has, initially without contact.
  PulledHands(PulledParts parts, const PullOptions& options);
  /// They touch as those whose state this is. Throws Error for another number of hands.
  PulledHands(PulledParts parts, PulledState state);

  std::size_t count() const { return hands_.size(); }
  /// Whether poses of this time are later than the last ones since the hands were put down; without time between them
  /// no force can rise.
  bool isLater(double time_s) const noexcept { return !lastTime_s_ || time_s > *lastTime_s_; }
  /// Session::tick().
  std::span<const PulledTick> tick(std::span<const Pose> poses) noexcept;
  /// Lifts all hands; the next poses put them down elsewhere.
  void lift() noexcept;
  /// Replaces the options of the force law. Between ticks.
  void setForce(const ForceOptions& options);
  /// The same after finish() of the back end. Throws errors of earlier queries.
  PulledState state() const;
  bool hasFailed() const { return failure_ != nullptr; }
  /// Throws the failure of taking edits, if there was one.
  void check() const;

 private:
  void begin(const ForceLaw& law);
  void publish(std::span<const Pose> poses) noexcept;

  PulledParts parts_;
  PullOptions options_;
  std::vector<HandForce> forces_;     // one for each hand
  std::vector<PulledTick> hands_;     // of the last tick
  std::optional<double> lastTime_s_;  // since the hands were put down
  std::exception_ptr failure_;
};

}  // namespace palpate
