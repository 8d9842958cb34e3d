// The seam between the servo loop, which knows no GPU, and whatever answers its question: "the stylus is here; where is
// the surface?"
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

/// Hands that touch one cloud at the same time, at most.
inline constexpr std::size_t kMaxHands = 8;

/// Sizes of the force that an answer asked for and of that which the hand got, after all limits: all of it, where
/// nobody says otherwise.
struct FeltForce {
  double asked_N = 1, got_N = 1;

  /// Of a force that was already held to `most_N`; nothing where none was asked for.
  double share(double most_N = std::numeric_limits<double>::infinity()) const {
    const double asked = std::min(asked_N, most_N);
    return asked > 0 ? std::min(1.0, got_N / asked) : 0;
  }
};

/// Where a hand is, in model units, and when.
struct Pose {
  double time_s = 0;
  DVec3 hip{0};  ///< haptic interface point
  /// The hand means to change what it touches, where there is a tool. Otherwise it only feels.
  bool sculpts = true;
  DQuat turn{1, 0, 0, 0};  ///< of the tool's frame against the model's; only a tool of many points asks for it
  /// At the last tick. What simulates counts the hand's work by it, and nothing else depends on it.
  FeltForce felt;
};

/// What the surface answers to one pose. Positions in model units.
struct Contact {
  DVec3 proxy{0};   ///< surface contact point; equals the HIP when there is no contact
  DVec3 normal{0};  ///< unit, outward, at the proxy; zero where no surface was in reach
  bool touching = false;
  bool fresh = false;            ///< from this tick's own query
  bool valid = false;            ///< false: a fault; the force must be zero
  bool lost = false;             ///< and there will never be a valid answer again
  bool isWithin = false;         ///< nothing is touched, though the HIP has not come out in front of the surface
  std::uint32_t neighbours = 0;  ///< points within the support radius of the proxy (of the HIP when free)
  double gpu_us = 0;             ///< time on the GPU; 0 where it was not measured
  DVec3 velocity{0};             ///< of the surface there, model units per second; zero where points stand still
  double dataTime_s = -1;        ///< of the pose that an answer which is not fresh was made from; negative: not known
  /// On the hand, N, where it is known as such, as in matter that is simulated; otherwise a spring between HIP and
  /// proxy says it.
  std::optional<DVec3> force_N;
  DVec3 torque_mNm{0};  ///< on the hand about the proxy, beside such a force
};

/// What the surface answers to one point of a tool (ToolShape).
struct PointContact {
  DVec3 hip{0};      ///< where the point itself is
  double share = 0;  ///< of the tool's stiffness and damping
  Contact contact;
};

/// Answers poses in order. A hand is a group of probes: its HIP, and the points of its tool, where it has many. All
/// hands are answered at once, from the same state of the surface; the first one may change it, the others only feel.
class ContactQuery {
 public:
  virtual ~ContactQuery() = default;
  /// How many hands there are; always as many.
  virtual std::size_t hands() const noexcept { return 1; }
  /// One pose for each hand, all of the same time, and as many answers, which stand until the next call. Never blocks
  /// past `budget_us` (0: as long as it takes, for virtual time), throws nothing, and says valid = false on any fault.
  virtual std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept = 0;
  /// The same where there is one hand.
  Contact query(const Pose& pose, double budget_us) noexcept { return ask({&pose, 1}, budget_us).front(); }
  /// The force of the last answer is out: now is the time for what need not come before it, and for what makes the next
  /// answer come sooner. Never blocks for long.
  virtual void prepare() noexcept {}
  /// The last answer to a hand point by point, where its tool has many; always as many. The answer as a whole then
  /// stands for them: its proxy is the HIP and the sum of the ways from the points to their proxies, each times its
  /// share, so that a spring from the HIP to it has the force of all their springs; its normal is their mean by force;
  /// it touches when one of them does, is fresh and valid when all are, and its neighbours are the most that one of
  /// them has.
  virtual std::span<const PointContact> points(std::size_t /*hand*/) const noexcept { return {}; }
  /// The hand was lifted and is put down elsewhere with the next pose: there was no motion in between, and it touches
  /// nothing.
  virtual void resetHand(std::size_t /*hand*/) noexcept {}
};

/// Who answers one hand alone.
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
