#include "engine/io/polygon.hpp"

#include <algorithm>

namespace palpate {

namespace {

/// Twice the enclosed area, as a vector along the normal of the plane (Newell's method).
DVec3 twiceArea(std::span<const DVec3> around) {
  DVec3 sum(0);
  for (std::size_t k = 1; k + 1 < around.size(); ++k)
    sum += glm::cross(around[k] - around[0], around[k + 1] - around[0]);
  return sum;
}

/// Positive if the three turn left, seen against `normal`.
double turn(const DVec3& a, const DVec3& b, const DVec3& c, const DVec3& normal) {
  return glm::dot(glm::cross(b - a, c - b), normal);
}

bool isConvex(std::span<const DVec3> around, const DVec3& normal) {
  const std::size_t count = around.size();
  for (std::size_t k = 0; k < count; ++k)
    if (turn(around[k], around[(k + 1) % count], around[(k + 2) % count], normal) < 0) return false;
  return true;
}

/// The remaining corners, by their index in the polygon.
class Ears {
 public:
  Ears(std::span<const DVec3> around, const DVec3& normal) : around_(around), normal_(normal) {
    for (std::uint32_t k = 0; k < around.size(); ++k) left_.push_back(k);
  }

  std::size_t left() const { return left_.size(); }
  /// Removes a corner and returns its triangle: a spike, where the outline reverses; else an ear; else a corner
  /// collinear with its neighbours; else, due to rounding or crossing edges, the first three corners.
  std::array<std::uint32_t, 3> cut() {
    std::size_t tip = 1;
    if (!findTip(tip, [&](std::size_t k) { return isSpike(k); }) &&
        !findTip(tip, [&](std::size_t k) { return isEar(k); }))
      findTip(tip, [&](std::size_t k) { return turnAt(k) == 0; });
    const std::array<std::uint32_t, 3> ear = cornersAt(tip);
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(tip));
    return ear;
  }

 private:
  bool findTip(std::size_t& tip, auto&& suits) const {
    for (std::size_t k = 0; k < left_.size(); ++k)
      if (suits(k)) return tip = k, true;
    return false;
  }
  std::array<std::uint32_t, 3> cornersAt(std::size_t k) const {
    const std::size_t count = left_.size();
    return {left_[(k + count - 1) % count], left_[k], left_[(k + 1) % count]};
  }
  double turnAt(std::size_t k) const {
    const std::array<std::uint32_t, 3> corners = cornersAt(k);
    return turn(around_[corners[0]], around_[corners[1]], around_[corners[2]], normal_);
  }
  bool isSpike(std::size_t k) const {
    const std::array<std::uint32_t, 3> corners = cornersAt(k);
    const DVec3 there = around_[corners[1]] - around_[corners[0]], back = around_[corners[2]] - around_[corners[1]];
    return turnAt(k) == 0 && glm::dot(there, back) < 0;
  }
  bool isEar(std::size_t k) const {
    if (!(turnAt(k) > 0)) return false;
    const std::array<std::uint32_t, 3> ear = cornersAt(k);
    const std::array<DVec3, 3> corners{around_[ear[0]], around_[ear[1]], around_[ear[2]]};
    for (std::size_t other = 0; other < left_.size(); ++other)
      if (std::ranges::find(ear, left_[other]) == ear.end() && reachesInto(other, corners)) return false;
    return true;
  }
  /// Whether a corner lies inside the triangle, or on its outline with an edge that leads inside. Corners that only
  /// touch the outline do not count: both ends of a bridge to a hole have the same position.
  bool reachesInto(std::size_t other, const std::array<DVec3, 3>& ear) const {
    const std::array<std::uint32_t, 3> corners = cornersAt(other);
    const auto sideOf = [&](std::size_t edge, const DVec3& p) {
      return turn(ear[edge], ear[(edge + 1) % 3], p, normal_);
    };
    std::array<bool, 3> on{};
    for (std::size_t edge = 0; edge < 3; ++edge) {
      const double side = sideOf(edge, around_[corners[1]]);
      if (!(side >= 0)) return false;
      on[edge] = side == 0;
    }
    if (std::ranges::none_of(on, [](bool touches) { return touches; })) return true;
    return std::ranges::any_of(std::array{corners[0], corners[2]}, [&](std::uint32_t neighbour) {
      for (std::size_t edge = 0; edge < 3; ++edge)
        if (on[edge] && !(sideOf(edge, around_[neighbour]) > 0)) return false;
      return true;
    });
  }

  std::span<const DVec3> around_;
  DVec3 normal_;
  std::vector<std::uint32_t> left_;
};

}  // namespace

void addPolygon(std::span<const DVec3> around, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  const std::size_t count = around.size();
  if (count > 3 && count <= kLargestConcavePolygon) {
    const DVec3 normal = twiceArea(around);
    if (!isConvex(around, normal)) {
      for (Ears ears(around, normal); ears.left() > 2;) triangles.push_back(ears.cut());
      return;
    }
  }
  for (std::uint32_t k = 2; k < count; ++k) triangles.push_back({0, k - 1, k});
}

}  // namespace palpate
