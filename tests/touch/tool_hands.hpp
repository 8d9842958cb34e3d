// Hands with a tool of many points and a force law behind a back end.
#pragma once

#include <array>
#include <limits>
#include <utility>

#include "engine/touch/cpu_touch.hpp"
#include "engine/touch/touch_side.hpp"
#include "haptics/force_law.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/tick.hpp"

namespace palpate {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();
// Without limits and without damping: the force of a pose is that of its depth.
inline constexpr ForceOptions kSpring{
    .stiffness_N_per_mm = 0.8, .damping_N_s_per_mm = 0, .maxForce_N = kInfinite, .maxRise_N_per_s = kInfinite};

inline DQuat turnedAbout(const DVec3& axis, double angle) {
  return {std::cos(0.5 * angle), std::sin(0.5 * angle) * glm::normalize(axis)};
}

// A software driver takes many seconds to compile a step for validation: only the tests of the shader's memory accesses
// have it; all others share one device without it, and one step with friction.
inline constexpr double kFriction = 0.3;
class ToolFixture {
 protected:
  Device& device = plainDevice();
};

struct Felt {
  Contact contact;
  DVec3 force_N{0}, torque_mNm{0};
};

/// A back end with a force law behind it; model units are mm.
template <class Backend>
class HandWith {
 public:
  template <class... Args>
  explicit HandWith(Args&&... args) : backend_(std::forward<Args>(args)...), law_(kSpring, {}) {
    law_.feelWith(backend_.points(0).size());
  }
  Felt feel(const DVec3& hip, const DQuat& turn = {1, 0, 0, 0}, double budget_us = 0) {
    const Pose pose{.time_s = time_s_ += kTick_s, .hip = hip, .turn = turn};
    Felt felt{.contact = backend_.query(pose, budget_us)};
    felt.force_N = backend_.points(0).empty() ? law_.update(felt.contact, pose, kTick_s)
                                              : law_.update(felt.contact, backend_.points(0), pose, kTick_s);
    felt.torque_mNm = law_.torque_mNm();
    return felt;
  }
  /// Straight down from 8 above, in steps of 0.5.
  Felt press(double depth, const DQuat& turn = {1, 0, 0, 0}) {
    Felt felt;
    for (double z = 8; z > -depth; z -= 0.5) felt = feel({0.3, 0.2, z}, turn);
    return feel({0.3, 0.2, -depth}, turn);
  }
  Backend& backend() { return backend_; }

 private:
  Backend backend_;
  ForceLaw law_;
  double time_s_ = 0;
};
using GpuHand = HandWith<TouchSide>;
using CpuHand = HandWith<CpuTouch>;

inline constexpr std::array<ToolKind, 3> kManyPointed{ToolKind::pad, ToolKind::ball, ToolKind::spatula};

/// Runs the check on each back end, with its own instance.
template <class Check>
void onBoth(Device& device, const Scene& scene, const ToolShape& tool, Check&& check) {
  {
    CAPTURE("gpu");
    GpuHand hand(device, scene.cloud, TouchOptions{.radius = scene.radius, .friction = kFriction, .tools = {tool}});
    check(hand);
  }
  {
    CAPTURE("cpu");
    CpuHand hand(scene.cloud, CpuTouchOptions{.radius = scene.radius, .friction = kFriction, .tools = {tool}});
    check(hand);
  }
}

}  // namespace palpate
