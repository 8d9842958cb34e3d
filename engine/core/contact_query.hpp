// The seam between the servo loop, which knows no GPU, and whatever answers its question: "the stylus is here; where is
// the surface?"
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "engine/core/vec.hpp"

namespace palpate {

/// Where the device is, in model units.
struct Pose {
  double time_s = 0;
  DVec3 hip{0};  ///< haptic interface point
  /// The hand means to change what it touches, where there is a tool. Otherwise it only feels.
  bool sculpts = true;
  DQuat turn{1, 0, 0, 0};          ///< of the tool's frame against the model's; only a tool of many points asks for it
  std::optional<DVec3> secondHip;  ///< of another hand, which only feels, with its point alone; model units
};

/// What the surface answers to one pose. Positions in model units.
struct Contact {
  DVec3 proxy{0};   ///< surface contact point; equals the HIP when there is no contact
  DVec3 normal{0};  ///< unit, outward, at the proxy; zero where no surface was in reach
  bool touching = false;
  bool fresh = false;            ///< from this tick's own query
  bool valid = false;            ///< false: a fault; the force must be zero
  bool lost = false;             ///< and there will never be a valid answer again
  std::uint32_t neighbours = 0;  ///< points within the support radius of the proxy (of the HIP when free)
  double gpu_us = 0;             ///< time on the GPU; 0 where it was not measured
  double dataTime_s = -1;        ///< of the pose that an answer which is not fresh was made from; negative: not known
};

/// What the surface answers to one point of a tool (ToolShape).
struct PointContact {
  DVec3 hip{0};      ///< where the point itself is
  double share = 0;  ///< of the tool's stiffness and damping
  Contact contact;
};

/// Answers poses in order. query() never blocks past `budget_us` (0: as long as it takes, for virtual time), throws
/// nothing, and says valid = false on any fault.
class ContactQuery {
 public:
  virtual ~ContactQuery() = default;
  virtual Contact query(const Pose& pose, double budget_us) noexcept = 0;
  /// The force of the last answer is out: now is the time for what need not come before it, and for what makes the next
  /// answer come sooner. Never blocks for long.
  virtual void prepare() noexcept {}
  /// The last answer point by point, where the tool has many; always as many. The answer as a whole then stands for
  /// them: its proxy is the HIP and the sum of the ways from the points to their proxies, each times its share, so that
  /// a spring from the HIP to it has the force of all their springs; its normal is their mean by force; it touches when
  /// one of them does, is fresh and valid when all are, and its neighbours are the most that one of them has.
  virtual std::span<const PointContact> points() const noexcept { return {}; }
  /// The stylus was lifted and is put down elsewhere with the next pose: there was no motion in between, and nothing is
  /// touched.
  virtual void beginAnew() noexcept {}
  /// The last answer to Pose::secondHip, from the same state of the surface as that to the first hand. Not valid where
  /// nobody can answer two hands.
  virtual Contact second() const noexcept { return {}; }
  /// The second hand alone was lifted and is put down elsewhere.
  virtual void secondBeginsAnew() noexcept {}
};

}  // namespace palpate
