#include "engine/contact/surface.hpp"

namespace palpate {

// The variances are computed here with this rounding, which differs slightly from surfaceFrom()'s own.
SurfaceSample SurfaceSums::sample() const {
  const double weights = sums_.offsets.w;
  const DVec3 offsets(sums_.offsets), normals(sums_.normals);
  const double spread = (sums_.products.x - glm::dot(offsets, offsets) / weights) / weights;
  const double turn = (sums_.products.y - glm::dot(offsets, normals) / weights) / weights;
  return shared::surfaceFrom(sums_, spread, turn, radius_, static_cast<shared::uint>(kind_));
}

// Position noise leaves a ripple of 1.05 noise / (R / spacing) spacings: the sum of the squared weights is 0.222 (R /
// spacing)^2 on an even plane, that of the weights pi / 7 of it.
double wideningFor(double noise_spacings) {
  constexpr double kRipple = 1.05, kMaxRipple_spacings = 0.035, kMax = 2;
  if (!(noise_spacings > 0)) return 1;
  const double spacings = kRipple * noise_spacings / kMaxRipple_spacings;
  return std::clamp(spacings / static_cast<double>(shared::kSupportSpacings), 1.0, kMax);
}

double averageSurfaceBias(double radius, double sphereRadius) { return 0.0694 * radius * radius / sphereRadius; }

}  // namespace palpate
