#include "tests/render/gaussian_reference.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <optional>

#include "engine/cloud/gaussian_harmonics.hpp"

namespace palpate {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

struct Seen {
  DVec2 center{0};
  double xx = 0, xy = 0, yy = 0;  // inverse of the covariance
  DVec2 slope{0};
  double depth = 0, opacity = 0;
  DVec3 color{0};
};

Matrix rotationOf(const DVec4& quaternion) {
  const DVec4 q = quaternion / glm::length(quaternion);
  const double w = q[0], x = q[1], y = q[2], z = q[3];
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

/// Sigma = R S S^T R^T, in the axes of the camera, then J Sigma J^T (Zwicker et al. 2001, equations 23 to 31); the
/// third row of J leaves depth as it is.
Matrix covarianceOnScreen(const FileGaussian& g, const Camera& camera, const DVec3& eye, const UVec2& size_px) {
  const Camera::Axes axes = camera.axes();
  const Matrix rotation = rotationOf(g.rotation);
  const std::array<DVec3, 3> rows{axes.right, -axes.up, axes.forward};
  Matrix turned{};
  for (std::size_t i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      for (int m = 0; m < 3; ++m)
        turned[i][static_cast<std::size_t>(k)] +=
            rows[i][m] * rotation[static_cast<std::size_t>(m)][static_cast<std::size_t>(k)];
  const double f = camera.focal_px(size_px.y);
  Matrix j{{{f, 0, 0}, {0, f, 0}, {0, 0, 1}}};
  if (!camera.isOrthographic()) {
    const DVec2 middle = camera.center * DVec2(size_px), beside = 0.15 * DVec2(size_px);
    const DVec2 at =
        glm::clamp(DVec2(eye.x, -eye.y) / eye.z, -(middle + beside) / f, (DVec2(size_px) - middle + beside) / f);
    j = {{{f / eye.z, 0, -f * at.x / eye.z}, {0, f / eye.z, -f * at.y / eye.z}, {0, 0, 1}}};
  }
  Matrix factor{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t m = 0; m < 3; ++m)
        factor[i][k] += j[i][m] * turned[m][k] * std::exp(g.logScales[static_cast<int>(k)]);
  Matrix covariance{};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t m = 0; m < 3; ++m) covariance[i][k] += factor[i][m] * factor[k][m];
  return covariance;
}

std::optional<Seen> seenBy(const Camera& camera, const FileGaussian& g, const UVec2& size_px) {
  const auto isFinite = [](const DVec3& v) { return std::isfinite(v.x + v.y + v.z); };
  if (!isFinite(g.center) || !isFinite(g.logScales) || !isFinite(g.color)) return std::nullopt;
  if (!(glm::dot(g.rotation, g.rotation) > 0) || std::isnan(g.opacityLogit)) return std::nullopt;
  const Camera::Axes axes = camera.axes();
  const DVec3 to = g.center - camera.eye;
  const DVec3 eye(glm::dot(to, axes.right), glm::dot(to, axes.up), glm::dot(to, axes.forward));
  if (!(eye.z >= camera.nearDepth)) return std::nullopt;
  Matrix covariance = covarianceOnScreen(g, camera, eye, size_px);
  covariance[0][0] += 0.3, covariance[1][1] += 0.3;
  const double determinant = covariance[0][0] * covariance[1][1] - covariance[0][1] * covariance[0][1];
  Seen seen{.center = camera.center * DVec2(size_px) +
                      camera.focal_px(size_px.y) / camera.divisorAt(eye.z) * DVec2(eye.x, -eye.y),
            .xx = covariance[1][1] / determinant,
            .xy = -covariance[0][1] / determinant,
            .yy = covariance[0][0] / determinant,
            .depth = eye.z,
            .opacity = 1 / (1 + std::exp(-g.opacityLogit)),
            .color = 0.5 + 0.5 / std::sqrt(std::numbers::pi) * g.color};
  // The mean depth of the Gaussian there, given the position in the picture.
  seen.slope = {seen.xx * covariance[2][0] + seen.xy * covariance[2][1],
                seen.xy * covariance[2][0] + seen.yy * covariance[2][1]};
  const auto harmonics = harmonicsAt(camera.isOrthographic() ? axes.forward : glm::normalize(to));
  for (std::size_t k = 0; k < g.harmonics.size(); ++k) seen.color += harmonics[k] * g.harmonics[k];
  seen.color = glm::max(seen.color, DVec3(0));
  return seen;
}

CompositedPixel pixelOf(const std::vector<Seen>& sorted, const DVec2& place_px, double nearDepth) {
  CompositedPixel pixel;
  for (const Seen& g : sorted) {
    const DVec2 d = place_px - g.center;
    const double alpha =
        std::min(0.99, g.opacity * std::exp(-0.5 * (g.xx * d.x * d.x + 2 * g.xy * d.x * d.y + g.yy * d.y * d.y)));
    if (alpha < 1 / 255.0) continue;
    const double left = pixel.transmittance * (1 - alpha);
    if (pixel.transmittance > 0.5 && left <= 0.5) pixel.depth = std::max(g.depth + glm::dot(g.slope, d), nearDepth);
    pixel.color += pixel.transmittance * alpha * g.color;
    pixel.transmittance = left;
  }
  return pixel;
}

}  // namespace

std::shared_ptr<const GaussianRecords> recordsOf(const std::vector<FileGaussian>& gaussians) {
  std::vector<std::string> names{"x",       "y",       "z",       "f_dc_0", "f_dc_1", "f_dc_2", "opacity",
                                 "scale_0", "scale_1", "scale_2", "rot_0",  "rot_1",  "rot_2",  "rot_3"};
  const std::size_t rest = gaussians.empty() ? 0 : gaussians.front().harmonics.size();
  for (std::size_t k = 0; k < 3 * rest; ++k) names.push_back(fmt::format("f_rest_{}", k));
  std::vector<GaussianRecords::Column> columns;
  for (const std::string& name : names) columns.push_back({name, ScalarType::f32, sizeof(float) * columns.size()});
  std::vector<float> numbers;
  const auto add = [&](const auto& vector, int count) {
    for (int k = 0; k < count; ++k) numbers.push_back(static_cast<float>(vector[k]));
  };
  for (const FileGaussian& g : gaussians) {
    add(g.center, 3), add(g.color, 3);
    numbers.push_back(static_cast<float>(g.opacityLogit));
    add(g.logScales, 3), add(g.rotation, 4);
    for (int c = 0; c < 3; ++c)
      for (std::size_t k = 0; k < rest; ++k) numbers.push_back(static_cast<float>(g.harmonics[k][c]));
  }
  BareVector<std::byte> rows(numbers.size() * sizeof(float));
  if (!rows.empty()) std::memcpy(rows.data(), numbers.data(), rows.size());
  return std::make_shared<const GaussianRecords>(std::move(columns), std::move(rows));
}

std::vector<CompositedPixel> composited(const std::vector<FileGaussian>& gaussians, const Camera& camera,
                                        const UVec2& size_px) {
  std::vector<Seen> sorted;
  for (const FileGaussian& g : gaussians)
    if (const auto seen = seenBy(camera, g, size_px)) sorted.push_back(*seen);
  std::ranges::stable_sort(sorted, {}, &Seen::depth);
  std::vector<CompositedPixel> pixels;
  for (std::uint32_t y = 0; y < size_px.y; ++y)
    for (std::uint32_t x = 0; x < size_px.x; ++x)
      pixels.push_back(pixelOf(sorted, DVec2(x, y) + 0.5, camera.nearDepth));
  return pixels;
}

}  // namespace palpate
