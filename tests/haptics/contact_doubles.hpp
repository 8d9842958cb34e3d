// Surfaces with closed formulas as ContactQuery.
#pragma once

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "engine/core/contact_query.hpp"

namespace palpate {

/// A god-object on a sphere, with faults on demand.
class SphereContact : public OneHandQuery {
 public:
  explicit SphereContact(double radius, const DVec3& center = DVec3(0)) : radius_(radius), center_(center) {}

  /// From `from_s` until before `to_s` every answer is a fault: invalid, or valid with a proxy that is NaN.
  void failBetween(double from_s, double to_s, bool withNaN) {
    from_s_ = from_s;
    to_s_ = to_s;
    withNaN_ = withNaN;
  }

  Contact answerTo(const Pose& pose, double budget_us) noexcept override {
    smallestBudget_us = std::min(smallestBudget_us, budget_us);
    largestBudget_us = std::max(largestBudget_us, budget_us);
    const DVec3 offset = pose.hip - center_;
    const DVec3 normal = glm::normalize(offset);
    const bool touching = glm::length(offset) < radius_;
    Contact contact{.proxy = touching ? center_ + radius_ * normal : pose.hip,
                    .normal = normal,
                    .touching = touching,
                    .fresh = true,
                    .valid = true,
                    .neighbours = 30};
    if (pose.time_s >= from_s_ && pose.time_s < to_s_) {
      if (withNaN_)
        contact.proxy.x = std::numeric_limits<double>::quiet_NaN();
      else
        contact.valid = false;
    }
    return contact;
  }

  double smallestBudget_us = std::numeric_limits<double>::infinity();
  double largestBudget_us = 0;

 private:
  double radius_;
  DVec3 center_;
  double from_s_ = 0, to_s_ = 0;
  bool withNaN_ = false;
};

/// A sphere that all hands feel; counts put-downs.
class SharedSphere final : public ContactQuery {
 public:
  explicit SharedSphere(std::size_t hands, double radius = 50) : putDown(hands), sphere_(radius), answers_(hands) {}
  std::size_t hands() const noexcept override { return answers_.size(); }
  std::span<const Contact> ask(std::span<const Pose> poses, double budget_us) noexcept override {
    for (std::size_t i = 0; i < answers_.size(); ++i) answers_[i] = sphere_.query(poses[i], budget_us);
    ++queries;
    return answers_;
  }
  void resetHand(std::size_t hand) noexcept override { ++putDown[hand]; }

  int queries = 0;
  std::vector<int> putDown;

 private:
  SphereContact sphere_;
  std::vector<Contact> answers_;
};

/// A point of a tool that is pressed `depth` deep into a plane at its proxy.
inline PointContact pressedPoint(const DVec3& hip, double depth, double share, const DVec3& normal = {0, 0, 1}) {
  return {.hip = hip,
          .share = share,
          .contact = {.proxy = hip + depth * normal,
                      .normal = normal,
                      .touching = depth > 0,
                      .fresh = true,
                      .valid = true,
                      .neighbours = 20}};
}

/// A tool of two points, 4 to each side of the HIP, over a plane at `height`; the one at x < 0 is off the plane's edge.
class HalfOverPlane final : public OneHandQuery {
 public:
  explicit HalfOverPlane(double height = 0) : height_(height) {}
  Contact answerTo(const Pose& pose, double) noexcept override {
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const DVec3 hip = pose.hip + pose.turn * DVec3(i == 0 ? -4 : 4, 0, 0);
      points_[i] = pressedPoint(hip, i == 0 ? 0 : std::max(0.0, height_ - hip.z), 0.5);
      if (pose.time_s >= failsFrom_s) points_[i].contact.valid = false;
    }
    const bool touching = points_[1].contact.touching;
    return {.proxy = pose.hip + 0.5 * (points_[1].contact.proxy - points_[1].hip),
            .normal = {0, 0, touching ? 1 : 0},
            .touching = touching,
            .fresh = true,
            .valid = pose.time_s < failsFrom_s};
  }
  std::span<const PointContact> points(std::size_t /*hand*/) const noexcept override { return points_; }

  double failsFrom_s = std::numeric_limits<double>::infinity();

 private:
  double height_;
  std::array<PointContact, 2> points_{};
};

}  // namespace palpate
