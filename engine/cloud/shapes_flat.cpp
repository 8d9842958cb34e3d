// The plane and the cube.
#include <algorithm>
#include <array>
#include <cmath>

#include <glm/common.hpp>

#include "engine/cloud/shapes.hpp"

namespace palpate {
namespace {

class Plane final : public AnalyticShape {
 public:
  Plane(double size, const DVec3& center) : AnalyticShape(size, center) {}

  SurfacePoint closest(const DVec3& p) const override {
    const double half = 0.5 * size();
    const DVec3 local = p - center();
    return {center() + DVec3(std::clamp(local.x, -half, half), std::clamp(local.y, -half, half), 0), DVec3(0, 0, 1)};
  }

  AreaMap areaMap(unsigned) const override {
    return [size = size(), center = center()](const DVec2& s) {
      return SurfacePoint{center + size * DVec3(s.x - 0.5, s.y - 0.5, 0), DVec3(0, 0, 1)};
    };
  }
};

class Cube final : public AnalyticShape {
 public:
  Cube(double size, const DVec3& center) : AnalyticShape(size, center) {}

  SurfacePoint closest(const DVec3& p) const override {
    const DVec3 half(0.5 * size());
    const DVec3 local = p - center();
    const DVec3 inside = glm::clamp(local, -half, half);
    const DVec3 offset = local - inside;
    const double distance = glm::length(offset);
    if (distance > 0) return {center() + inside, offset / distance};
    // In the cube or on it: projected to the nearest face.
    int axis = 0;
    for (int k = 1; k < 3; ++k)
      if (std::abs(local[k]) > std::abs(local[axis])) axis = k;
    const double side = std::copysign(1.0, local[axis]);
    DVec3 onFace = local, normal(0);
    onFace[axis] = side * half[axis];
    normal[axis] = side;
    return {center() + onFace, normal};
  }

  /// Each face takes a sixth of the first coordinate.
  AreaMap areaMap(unsigned) const override {
    return [size = size(), center = center()](const DVec2& s) {
      const int face = std::min(static_cast<int>(6 * s.x), 5);
      const int axis = face / 2;
      const double side = face % 2 ? 1.0 : -1.0;
      DVec3 unit(0), normal(0);
      normal[axis] = side;
      unit[axis] = 0.5 * side;
      unit[(axis + 1) % 3] = 6 * s.x - face - 0.5;
      unit[(axis + 2) % 3] = s.y - 0.5;
      return SurfacePoint{center + size * unit, normal};
    };
  }
};

}  // namespace

std::unique_ptr<AnalyticShape> makePlane(double size, const DVec3& center) {
  return std::make_unique<Plane>(size, center);
}
std::unique_ptr<AnalyticShape> makeCube(double size, const DVec3& center) {
  return std::make_unique<Cube>(size, center);
}

}  // namespace palpate
