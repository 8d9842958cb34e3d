// A sphere with soft bumps: a star-shaped form, symmetric about its centre.
#include <array>
#include <numbers>

#include "engine/cloud/parametric_shape.hpp"
#include "engine/cloud/shapes.hpp"

namespace palpate {
namespace {

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

}  // namespace

std::unique_ptr<AnalyticShape> makeBumpySphere(double size, const DVec3& center) {
  return std::make_unique<ParametricShape<BumpySphere>>(size, center);
}

}  // namespace palpate
