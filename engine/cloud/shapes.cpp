// The built-in shapes, and their table. `size` is the longest side, model units.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <glm/common.hpp>

#include "engine/cloud/parametric_shape.hpp"
#include "engine/core/error.hpp"
#include "engine/core/unknown_name.hpp"

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

// A sphere with soft bumps: a star-shaped form, symmetric about its centre.

/// r(direction) = 1 + sum of a cos(k . direction): plane waves restricted to the unit sphere, which are sums of even
/// spherical harmonics up to about the degree |k|.
class BumpySphere {
 public:
  using Site = DVec3;  // direction, unit length
  static constexpr GridSize kSeeds{128, 256};
  static constexpr GridSize kTable{512, 1024};

  DVec3 site(const DVec2& square) const {
    const double z = 1 - 2 * square.x;
    const double ring = std::sqrt(std::max(0.0, 1 - z * z));
    const double angle = 2 * std::numbers::pi * square.y;
    return {ring * std::cos(angle), ring * std::sin(angle), z};
  }

  JetVec3 at(const DVec3& direction) const {
    const Frame3 frame = frameAround(direction);
    const Jet u = Jet::parameterU(0), v = Jet::parameterV(0);
    const auto component = [&](int k) { return Jet(direction[k]) + u * Jet(frame.u[k]) + v * Jet(frame.v[k]); };
    const JetVec3 d = normalize(JetVec3{component(0), component(1), component(2)});
    Jet radius = 1.0;
    for (const Wave& wave : kWaves)
      radius = radius + Jet(wave.amplitude) * cos(dot(JetVec3{wave.k.x, wave.k.y, wave.k.z}, d));
    return radius * d;
  }

  DVec3 moved(const DVec3& direction, const DVec2& change) const {
    const Frame3 frame = frameAround(direction);
    return glm::normalize(direction + change.x * frame.u + change.y * frame.v);
  }

  /// The square maps to the sphere with constant density (Archimedes); the rest is the form relative to the sphere.
  double areaDensity(const DVec2& square) const {
    const JetVec3 surface = at(site(square));
    return glm::length(glm::cross(surface.u(), surface.v()));
  }

 private:
  struct Wave {
    DVec3 k;
    double amplitude;
  };
  static constexpr std::array<Wave, 6> kWaves{{{{5.1, 1.3, -2.2}, 0.016},
                                               {{-1.7, 5.6, 1.9}, 0.016},
                                               {{2.4, -1.1, 5.8}, 0.016},
                                               {{7.3, -5.2, 2.9}, 0.009},
                                               {{-3.6, 4.4, 7.7}, 0.009},
                                               {{4.9, 7.9, -4.1}, 0.009}}};
};

// The built-in sculpture: a tube of varying thickness along a trefoil knot: smooth in one part, fluted in the next,
// covered with scales in the third.

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

template <class Shape>
std::unique_ptr<AnalyticShape> make(double size, const DVec3& center) {
  return std::make_unique<Shape>(size, center);
}

struct Entry {
  std::string_view name;
  std::unique_ptr<AnalyticShape> (*make)(double size, const DVec3& center);
};
constexpr std::array<Entry, 6> kShapes{{{"plane", make<Plane>},
                                        {"cube", make<Cube>},
                                        {"sphere", make<Sphere>},
                                        {"torus", make<Torus>},
                                        {"bumpy-sphere", make<ParametricShape<BumpySphere>>},
                                        {"sculpture", make<ParametricShape<Sculpture>>}}};

constexpr auto kShapeNames = [] {
  std::array<std::string_view, kShapes.size()> names;
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = kShapes[k].name;
  return names;
}();

}  // namespace

std::span<const std::string_view> shapeNames() { return kShapeNames; }

std::unique_ptr<AnalyticShape> makeShape(std::string_view name, double size, const DVec3& center) {
  if (!(size > 0) || !std::isfinite(size)) throw UsageError("a shape of size {}; expected a number above 0", size);
  if (!isFinite(center)) throw UsageError("a shape's centre must be three finite numbers");
  for (const Entry& entry : kShapes)
    if (entry.name == name) return entry.make(size, center);
  throw UsageError("{}", unknownName("shape", name, kShapeNames));
}

}  // namespace palpate
