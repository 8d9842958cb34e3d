#pragma once

#include "engine/core/held_contact.hpp"

namespace palpate {

/// A second hand on the same cloud, from pose to pose: what was answered to it last, and what it is told. Both back
/// ends keep one.
class SecondContact {
 public:
  /// A new pose: unless it is answered or held, it is a fault.
  void ask(const Pose& pose) { told_ = {.proxy = placeOf(pose)}; }
  void answered(const Contact& contact, const Pose& pose) {
    told_ = last_ = contact;
    lastPose_ = poseOf(pose);
  }
  /// For a pose that got no answer of its own.
  void hold(const Pose& pose) { told_ = heldContact(last_, lastPose_, poseOf(pose)); }
  /// It was lifted, or all that was answered to it counts no more.
  void forget() { last_.touching = told_.touching = false; }

  const Contact& told() const { return told_; }

  /// Where the second hand is; with the first, in a pose that knows of one alone.
  static DVec3 placeOf(const Pose& pose) { return pose.secondHip.value_or(pose.hip); }

 private:
  static Pose poseOf(const Pose& pose) { return {.time_s = pose.time_s, .hip = placeOf(pose)}; }

  Contact last_, told_;
  Pose lastPose_;
};

}  // namespace palpate
