// Surfaces with closed formulas behind the ContactQuery seam.
#pragma once

#include <algorithm>
#include <limits>

#include "engine/core/contact_query.hpp"

namespace palpate {

/// A god-object on a sphere; faults on demand.
class SphereContact : public ContactQuery {
 public:
  explicit SphereContact(double radius, const DVec3& center = DVec3(0)) : radius_(radius), center_(center) {}

  /// From `from_s` until before `to_s` every answer is a fault: not valid, or valid with a proxy that is no number.
  void failBetween(double from_s, double to_s, bool withNaN) {
    from_s_ = from_s;
    to_s_ = to_s;
    withNaN_ = withNaN;
  }

  Contact query(const Pose& pose, double budget_us) noexcept override {
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

}  // namespace palpate
