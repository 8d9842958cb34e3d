#include "engine/io/polygon.hpp"

#include <algorithm>

namespace palpate {

namespace {

/// Twice the area that the corners enclose, along the normal of their plane (Newell's method).
DVec3 twiceArea(std::span<const DVec3> around) {
  DVec3 sum(0);
  for (std::size_t k = 1; k + 1 < around.size(); ++k)
    sum += glm::cross(around[k] - around[0], around[k + 1] - around[0]);
  return sum;
}

/// Positive where the three turn left, seen against `normal`.
double turn(const DVec3& a, const DVec3& b, const DVec3& c, const DVec3& normal) {
  return glm::dot(glm::cross(b - a, c - b), normal);
}

bool isConvex(std::span<const DVec3> around, const DVec3& normal) {
  const std::size_t count = around.size();
  for (std::size_t k = 0; k < count; ++k)
    if (turn(around[k], around[(k + 1) % count], around[(k + 2) % count], normal) < 0) return false;
  return true;
}

/// The corners that are left, by their numbers around the polygon.
class Ears {
 public:
  Ears(std::span<const DVec3> around, const DVec3& normal) : around_(around), normal_(normal) {
    for (std::uint32_t k = 0; k < around.size(); ++k) left_.push_back(k);
  }

  std::size_t left() const { return left_.size(); }
  /// Takes one off and gives its corners; where rounding or crossing edges leave none, the first three.
  std::array<std::uint32_t, 3> cut() {
    std::size_t tip = 1;
    for (std::size_t k = 0; k < left_.size(); ++k)
      if (isEar(k)) {
        tip = k;
        break;
      }
    const std::array<std::uint32_t, 3> ear = cornersAt(tip);
    left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(tip));
    return ear;
  }

 private:
  std::array<std::uint32_t, 3> cornersAt(std::size_t k) const {
    const std::size_t count = left_.size();
    return {left_[(k + count - 1) % count], left_[k], left_[(k + 1) % count]};
  }
  bool isEar(std::size_t k) const {
    const std::array<std::uint32_t, 3> ear = cornersAt(k);
    const DVec3 &a = around_[ear[0]], &b = around_[ear[1]], &c = around_[ear[2]];
    if (!(turn(a, b, c, normal_) > 0)) return false;
    return std::ranges::none_of(left_, [&](std::uint32_t other) {
      if (std::ranges::find(ear, other) != ear.end()) return false;
      const DVec3& p = around_[other];
      return turn(a, b, p, normal_) >= 0 && turn(b, c, p, normal_) >= 0 && turn(c, a, p, normal_) >= 0;
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
