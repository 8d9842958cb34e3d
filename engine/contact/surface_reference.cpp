#include "engine/contact/surface_reference.hpp"

#include <cmath>
#include <numbers>

namespace palpate {

SurfaceSample SurfaceSums::sample() const {
  const SurfaceSample undefined{.neighbours = neighbours_};
  const double length = glm::length(normals_);
  if (neighbours_ < shared::kMinNeighbours || !(length > static_cast<double>(shared::kLeastNormal) * weights_))
    return undefined;
  const DVec3 mean = offsets_ / weights_;
  SurfaceSample sample{.defined = true, .normal = normals_ / length, .neighbours = neighbours_};
  sample.distance = -glm::dot(sample.normal, mean);
  if (kind_ != SurfaceKind::average) fitSphere(sample);
  const DVec3 aside = mean - glm::dot(mean, sample.normal) * sample.normal;
  if (!sample.defined || glm::length(aside) >= static_cast<double>(shared::kFurthestAside)) return undefined;
  sample.distance *= radius_;
  return sample;
}

// The zero set of u(y) = u0 + ul.y + u4 y.y, y relative to the place: a sphere, or a plane where u4 = 0.
void SurfaceSums::fitSphere(SurfaceSample& sample) const {
  const double spread = (squares_ - glm::dot(offsets_, offsets_) / weights_) / weights_;
  const double turn = (heights_ - glm::dot(offsets_, normals_) / weights_) / weights_;
  const double strongest = 0.5 * static_cast<double>(shared::kStrongestCurvature);
  const double u4 =
      std::clamp(0.5 * turn / (spread + static_cast<double>(shared::kLeastSpread)), -strongest, strongest);
  const DVec3 ul = (normals_ - 2.0 * u4 * offsets_) / weights_;
  const double u0 = -(glm::dot(ul, offsets_) + u4 * squares_) / weights_;
  const double slope = glm::length(ul);
  sample.defined = slope > static_cast<double>(shared::kLeastNormal);
  if (!sample.defined) return;
  sample.normal = ul / slope;
  // The nearer root, in the form that does not cancel where the sphere is almost a plane.
  sample.distance = 2.0 * u0 / (slope + std::sqrt(std::max(0.0, slope * slope - 4.0 * u0 * u4)));
}

double SurfaceSums::robustWeight(const DVec3& d, const DVec3& normal) const {
  const DVec3 turn = (normal - before_->normal) / static_cast<double>(shared::kSharpNormal);
  const double height =
      (-glm::dot(d, normal) - before_->distance / radius_) / static_cast<double>(shared::kSharpHeight);
  return std::exp(-glm::dot(turn, turn) - height * height);
}

double localRadius(double radius, double weights, double smallest, double largest) {
  if (!(weights > 0)) return largest;
  const double spacing = radius * std::sqrt(std::numbers::pi / 7 / weights);
  return std::clamp(static_cast<double>(shared::kSupportSpacings) * spacing, smallest, largest);
}

// Positions that are off by `noise_spacings` leave a ripple of 1.05 noise / (R / spacing) spacings: the sum of the
// squared weights is 0.222 (R / spacing)^2 on an even plane, that of the weights pi / 7 of it.
double wideningFor(double noise_spacings) {
  constexpr double kRipple = 1.05, kMostRipple_spacings = 0.035, kMost = 2;
  if (!(noise_spacings > 0)) return 1;
  const double spacings = kRipple * noise_spacings / kMostRipple_spacings;
  return std::clamp(spacings / static_cast<double>(shared::kSupportSpacings), 1.0, kMost);
}

namespace {

double smoothstep(double low, double high, double x) {
  const double share = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return share * share * (3.0 - 2.0 * share);
}

}  // namespace

double turnWeight(SurfaceKind kind, double cosine) {
  if (kind != SurfaceKind::sharp) return facingWeight(cosine);
  return smoothstep(shared::kAcrossEdge, shared::kThisSide, cosine);
}

double wideWhereFlat(double narrow, double wide, double meanNormal) {
  return std::lerp(wide, narrow, smoothstep(shared::kFlatTurn, shared::kFoldTurn, 1.0 - meanNormal));
}

double averageSurfaceBias(double radius, double sphereRadius) { return 0.0694 * radius * radius / sphereRadius; }

}  // namespace palpate
