// A hand that slides off the open rim of a sheet under load and returns, for each back end.
#pragma once

#include <doctest/doctest.h>

#include <functional>
#include <memory>

#include "engine/cloud/point_cloud.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// A square sheet of 40 mm that faces up, with a point per square millimetre.
inline PointCloud openSheet() {
  PointCloud cloud;
  for (int y = -20; y <= 20; ++y)
    for (int x = -20; x <= 20; ++x) {
      cloud.positions.emplace_back(x, y, 0);
      cloud.normals.emplace_back(0, 0, 1);
    }
  return cloud;
}
constexpr double kSheetRadius = 4;

using MakeRimTouch = std::function<std::unique_ptr<TouchBackend>(const PointCloud& cloud, double radius)>;

/// Pressed 3 mm deep and moved off at 0.1 m/s it loses the surface while it is behind it; then it is caught on the side
/// from which it returns.
inline void checkRim(const MakeRimTouch& make) {
  constexpr double kStep_mm = 0.1;
  for (const double side : {-1.0, 1.0}) {
    CAPTURE(side);
    const auto touch = make(openSheet(), kSheetRadius);
    Contact contact;
    DVec3 hip(0.3, 0.2, 4);
    int ticks = 0, lost = 0;
    const auto goTo = [&](const DVec3& to) {
      while (glm::distance(hip, to) > 1e-9) {
        const DVec3 way = to - hip;
        hip = glm::length(way) > kStep_mm ? hip + kStep_mm * glm::normalize(way) : to;
        const bool touched = contact.touching;
        contact = touch->query({.time_s = 1e-3 * ticks++, .hip = hip}, 0);
        CHECK(contact.valid);
        if (!touched || contact.touching) continue;
        ++lost;
        CHECK(contact.isWithin);
      }
    };
    goTo({0.3, 0.2, -3});
    CHECK(contact.touching);
    CHECK_FALSE(contact.isWithin);
    goTo({30, 0.2, -3});
    CHECK_FALSE(contact.touching);
    CHECK(lost == 1);
    goTo({30, 0.2, 3 * side});
    goTo({5, 0.2, 3 * side});
    CHECK_FALSE(contact.touching);
    CHECK_FALSE(contact.isWithin);
    goTo({5, 0.2, -1 * side});
    CHECK(contact.touching);
    CHECK(contact.normal.z * side > 0.99);
    CHECK(lost == 1);
  }
}

}  // namespace palpate
