// The sphere and the torus.
#include <cmath>
#include <numbers>

#include "engine/cloud/shapes.hpp"

namespace palpate {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

class Sphere final : public AnalyticShape {
 public:
  Sphere(double size, const DVec3& center) : AnalyticShape(size, center) {}

  SurfacePoint closest(const DVec3& p) const override {
    const DVec3 local = p - center();
    const double distance = glm::length(local);
    const DVec3 normal = distance > 0 ? local / distance : DVec3(0, 0, 1);
    return {center() + 0.5 * size() * normal, normal};
  }

  /// Slices of equal height have equal area (Archimedes).
  AreaMap areaMap(unsigned) const override {
    return [radius = 0.5 * size(), center = center()](const DVec2& s) {
      const double z = 1 - 2 * s.x;
      const double ring = std::sqrt(std::max(0.0, 1 - z * z));
      const DVec3 normal(ring * std::cos(kTurn * s.y), ring * std::sin(kTurn * s.y), z);
      return SurfacePoint{center + radius * normal, normal};
    };
  }
};

class Torus final : public AnalyticShape {
 public:
  Torus(double size, const DVec3& center) : AnalyticShape(size, center), major_(0.35 * size), minor_(0.15 * size) {}

  SurfacePoint closest(const DVec3& p) const override {
    const DVec3 local = p - center();
    const double fromAxis = std::hypot(local.x, local.y);
    const DVec3 outward = fromAxis > 0 ? DVec3(local.x, local.y, 0) / fromAxis : DVec3(1, 0, 0);
    const DVec3 fromRing = local - major_ * outward;
    const double distance = glm::length(fromRing);
    const DVec3 normal = distance > 0 ? fromRing / distance : outward;
    return {center() + major_ * outward + minor_ * normal, normal};
  }

  /// Area grows with R + r cos(angle) around the tube: solves R a + r sin(a) = 2 pi R s for the angle a by Newton's
  /// method, which converges from s = a because r < R.
  AreaMap areaMap(unsigned) const override {
    return [major = major_, minor = minor_, center = center()](const DVec2& s) {
      const double ratio = minor / major;
      double angle = kTurn * s.x;
      for (int step = 0; step < 50; ++step) {
        const double change = (angle + ratio * std::sin(angle) - kTurn * s.x) / (1 + ratio * std::cos(angle));
        angle -= change;
        if (std::abs(change) < 1e-15) break;
      }
      const DVec3 outward(std::cos(kTurn * s.y), std::sin(kTurn * s.y), 0);
      const DVec3 normal = std::cos(angle) * outward + DVec3(0, 0, std::sin(angle));
      return SurfacePoint{center + major * outward + minor * normal, normal};
    };
  }

 private:
  double major_, minor_;
};

}  // namespace

std::unique_ptr<AnalyticShape> makeSphere(double size, const DVec3& center) {
  return std::make_unique<Sphere>(size, center);
}
std::unique_ptr<AnalyticShape> makeTorus(double size, const DVec3& center) {
  return std::make_unique<Torus>(size, center);
}

}  // namespace palpate
