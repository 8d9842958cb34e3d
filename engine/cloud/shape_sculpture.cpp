// The built-in sculpture: a tube of varying thickness along a trefoil knot: smooth in one part, fluted in the next,
// covered with scales in the third.
#include <numbers>

#include "engine/cloud/parametric_shape.hpp"
#include "engine/cloud/shapes.hpp"

namespace palpate {
namespace {

/// P(t, a) = C(t) + r(t, a) (cos a N(t) - sin a B(t)), with the principal normal N and the binormal B of the knot C.
/// The curvature of a trefoil never vanishes, so its Frenet frame is smooth and closes.
class Sculpture {
 public:
  using Site = DVec2;  // t along the knot, a around it, 0 to 2 pi each
  static constexpr GridSize kSeeds{2048, 96};
  static constexpr GridSize kTable{4096, 256};

  DVec2 site(const DVec2& square) const { return 2 * std::numbers::pi * square; }
  DVec2 moved(const DVec2& site, const DVec2& change) const { return site + change; }

  JetVec3 at(const DVec2& site) const {
    // Tables and seeds query consecutive sites around the same position of the knot.
    thread_local Ring ring = ringAt(site.x);
    if (ring.t.value != site.x) ring = ringAt(site.x);
    const Jet a = Jet::parameterV(site.y);
    const Jet r = radius(ring, a);
    return ring.knot.point + r * (cos(a) * ring.knot.normal - sin(a) * ring.knot.binormal);
  }

  double areaDensity(const DVec2& square) const {
    const JetVec3 surface = at(site(square));
    return glm::length(glm::cross(surface.u(), surface.v()));
  }

 private:
  static constexpr double kRing = 2.0;   // radius of the knot's middle line around the z axis
  static constexpr double kWide = 0.95;  // radius of the winding around that line, in the plane
  static constexpr double kHigh = 1.0;   // and along z

  struct Knot {
    JetVec3 point, normal, binormal;
  };

  /// Values that are constant around the tube.
  struct Ring {
    Jet t, along, body, scaled, fluted;
    Knot knot;
  };

  static Ring ringAt(double place) {
    const Jet t = Jet::parameterU(place);
    return {.t = t,
            .along = t + 0.08 * sin(3.0 * t),  // about the arc length of the knot, so that scales are equally long
            .body = 0.60 + 0.13 * cos(t - 1.2) + 0.02 * cos(6.0 * t),
            .scaled = plateau(t, 1.2, 0.35, 9.0),
            .fluted = plateau(t, 3.7, 0.60, 14.0),
            .knot = knotAt(t)};
  }

  static Knot knotAt(const Jet& t) {
    const Jet c2 = cos(2.0 * t), s2 = sin(2.0 * t), c3 = cos(3.0 * t), s3 = sin(3.0 * t);
    const Jet ring = kRing + kWide * c3;
    const Jet ring1 = -3.0 * kWide * s3, ring2 = -9.0 * kWide * c3;  // derivatives by t
    const JetVec3 first{ring1 * c2 - 2.0 * ring * s2, ring1 * s2 + 2.0 * ring * c2, 3.0 * kHigh * c3};
    const JetVec3 second{ring2 * c2 - 4.0 * ring1 * s2 - 4.0 * ring * c2,
                         ring2 * s2 + 4.0 * ring1 * c2 - 4.0 * ring * s2, -9.0 * kHigh * s3};
    const JetVec3 binormal = normalize(cross(first, second));
    return {{ring * c2, ring * s2, kHigh * s3}, cross(binormal, normalize(first)), binormal};
  }

  /// 1 where t is within about acos(edge) of `center`, else 0, with a soft border.
  static Jet plateau(const Jet& t, double center, double edge, double steepness) {
    const Jet s = inverseSqrt(1.0 + exp(-steepness * (cos(t - center) - edge)));
    return s * s;
  }

  /// Rows of scales, each row shifted by half a scale; every one rises slowly and falls off steeply along t.
  static Jet scales(const Jet& along, const Jet& a) {
    constexpr double kAround = 15, kAlong = 64, kSkew = 0.5;
    const Jet right = kAround * a + kAlong * along, left = kAround * a - kAlong * along;
    const Jet skewedRight = right + kSkew * cos(right), skewedLeft = left - kSkew * cos(left);
    const Jet onBack = 0.58 - 0.42 * cos(a);  // the inside of a bend is a smoother belly
    return onBack * exp(1.1 * (cos(skewedRight) + cos(skewedLeft) - 2.0));
  }

  /// Ridges that wind around the tube.
  static Jet flutes(const Jet& t, const Jet& a) {
    constexpr double kAround = 9, kTwist = 22;
    return exp(1.6 * (cos(kAround * a + kTwist * t) - 1.0));
  }

  static Jet radius(const Ring& ring, const Jet& a) {
    constexpr double kScaleHeight = 0.084, kFluteHeight = 0.085;
    return ring.body + kScaleHeight * (ring.scaled * scales(ring.along, a)) +
           kFluteHeight * (ring.fluted * flutes(ring.t, a));
  }
};

}  // namespace

std::unique_ptr<AnalyticShape> makeSculpture(double size, const DVec3& center) {
  return std::make_unique<ParametricShape<Sculpture>>(size, center);
}

}  // namespace palpate
