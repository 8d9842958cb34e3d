// The seam between the servo loop, which knows no GPU, and the back end that answers its query: "the stylus is here;
// where is the surface?"
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "engine/core/check.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

/// Maximum number of hands that touch one cloud at the same time.
inline constexpr std::size_t kMaxHands = 8;

/// Magnitudes of the requested force and of the force that the hand received after all limits. By default the full
/// force was received.
struct FeltForce {
  double asked_N = 1, got_N = 1;

  /// Share that was received of a force limited to `most_N`; zero if no force was requested.
  double share(double most_N = std::numeric_limits<double>::infinity()) const {
    const double asked = std::min(asked_N, most_N);
    return asked > 0 ? std::min(1.0, got_N / asked) : 0;
  }
};

/// What makes a hand sculpt, and so how long a stroke lasts.
enum class Press : std::uint8_t {
  none,     ///< it only feels
  contact,  ///< it sculpts what it touches: a stroke is one contact
  button    ///< a button is held: a stroke lasts as long, also where the hand touches nothing
};

/// Position of a hand, in model units, and its time.
struct Pose {
  double time_s = 0;
  DVec3 hip{0};  ///< haptic interface point
  /// Whether the hand sculpts what it touches, if there is a tool. Otherwise it only feels.
  bool sculpts = true;
  bool byButton = false;   ///< a button says whether it sculpts
  DQuat turn{1, 0, 0, 0};  ///< rotation from the tool's to the model's frame; used only by tools of many points
  /// Force at the last tick. Only simulations use it, to account for the hand's work.
  FeltForce felt;

  Press press() const { return !sculpts ? Press::none : byButton ? Press::button : Press::contact; }
};

/// The answer to one pose. Positions in model units.
struct Contact {
  DVec3 proxy{0};   ///< surface contact point; equals the HIP when there is no contact
  DVec3 normal{0};  ///< unit, outward, at the proxy; zero if no surface was in reach
  bool touching = false;
  bool fresh = false;            ///< from this tick's own query
  bool valid = false;            ///< false: a fault; the force must be zero
  bool lost = false;             ///< the back end cannot give a valid answer any more
  bool isWithin = false;         ///< nothing is touched, but the HIP has not returned to the front of the surface yet
  std::uint32_t neighbours = 0;  ///< points within the support radius of the proxy (of the HIP when free)
  double gpu_us = 0;             ///< time on the GPU; 0 if it was not measured
  DVec3 velocity{0};  ///< velocity of the surface at the proxy, model units per second; zero where points stand still
  double dataTime_s = -1;  ///< time of the pose from which an answer that is not fresh was made; negative: unknown
  /// Force on the hand, N, where it is known directly, as in simulated matter; otherwise the spring between HIP and
  /// proxy gives the force.
  std::optional<DVec3> force_N;
  DVec3 torque_mNm{0};  ///< torque on the hand about the proxy, in addition to such a force
};

/// The answer to one point of a tool (ToolShape).
struct PointContact {
  DVec3 hip{0};      ///< position of the point itself
  double share = 0;  ///< of the tool's stiffness and damping
  Contact contact;
};

/// Answers poses in order. A hand is a group of probes: its HIP, and the points of its tool if it has several. All
/// hands are answered at once, from the same state of the surface; only the first hand may change it.
class ContactQuery {
 public:
  virtual ~ContactQuery() = default;
  /// Number of hands; constant.
  virtual std::size_t hands() const noexcept { return 1; }
  /// Takes one pose for each hand, all of the same time. The answers are valid until the next call. Never blocks past
  /// `budget_us` (0: no limit, for virtual time), throws nothing, and sets valid = false on any fault. Begins a tick.
  virtual std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept = 0;
  /// Ends the tick, once the force of its answer has been sent and before any other call: the answer takes effect on
  /// the surface, and the next one is prepared. Never blocks for long. No effect between ticks.
  virtual void endTick() noexcept {}
  /// A whole tick.
  std::span<const Contact> query(std::span<const Pose> poses, double budget_us) noexcept {
    const std::span<const Contact> answers = ask(poses, budget_us);
    endTick();
    return answers;
  }
  /// The same for a single hand.
  Contact query(const Pose& pose, double budget_us) noexcept { return query({&pose, 1}, budget_us).front(); }
  /// The last answer to a hand for each point of its tool, if it has several; their number is constant. The combined
  /// answer: its proxy is the HIP plus the sum of the displacements from the points to their proxies, each times its
  /// share, so that a spring from the HIP to it has the force of all their springs. Its normal is their mean weighted
  /// by force. It touches if any point touches, and is fresh and valid if all are. Its neighbours are the maximum over
  /// the points.
  virtual std::span<const PointContact> points(std::size_t /*hand*/) const noexcept { return {}; }
  /// The hand was lifted and is put down elsewhere with the next pose: it did not move in between and touches nothing.
  virtual void resetHand(std::size_t /*hand*/) noexcept {}
};

/// Base of queries for a single hand.
class OneHandQuery : public ContactQuery {
 public:
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept final {
    PALPATE_CHECK_EQ(poses.size(), 1u);
    answer_ = answerTo(poses.front(), budget_us);
    return {&answer_, 1};
  }

 private:
  virtual Contact answerTo(const Pose& pose, double budget_us) noexcept = 0;

  Contact answer_;
};

}  // namespace palpate
