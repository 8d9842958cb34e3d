#include "engine/io/gaussian_cloud.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "engine/cloud/gaussian_surface.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"

namespace palpate {

namespace {

bool isFinite(const Vec3& v) { return std::isfinite(glm::dot(v, v)); }

bool isGaussian(const GaussianScene& scene, std::size_t i) {
  constexpr double kFarthest = 1e30;  // as for other clouds
  const DVec3 p = scene.centers[i];
  const bool placed = std::abs(p.x) < kFarthest && std::abs(p.y) < kFarthest && std::abs(p.z) < kFarthest;
  const float turn = glm::dot(scene.rotations[i], scene.rotations[i]);
  return placed && isFinite(scene.logScales[i]) && turn > 0 && std::isfinite(turn) &&
         !std::isnan(scene.opacityLogits[i]) && isFinite(scene.colorHarmonics[i]);
}

/// Returns how many were removed. Makes opacities finite: full opacity has an infinite logit.
std::size_t leaveOutBad(GaussianScene& scene) {
  constexpr float kOpaque = 30;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < scene.size(); ++i) {
    if (!isGaussian(scene, i)) continue;
    scene.centers[kept] = scene.centers[i];
    scene.logScales[kept] = scene.logScales[i];
    scene.rotations[kept] = scene.rotations[i];
    scene.opacityLogits[kept] = std::clamp(scene.opacityLogits[i], -kOpaque, kOpaque);
    scene.colorHarmonics[kept] = scene.colorHarmonics[i];
    ++kept;
  }
  const std::size_t gone = scene.size() - kept;
  scene.centers.resize(kept);
  scene.logScales.resize(kept);
  scene.rotations.resize(kept);
  scene.opacityLogits.resize(kept);
  scene.colorHarmonics.resize(kept);
  return gone;
}

}  // namespace

std::string gaussiansInWords(std::uint64_t count) { return counted(count, "Gaussian"); }

StoredCloud surfaceOfGaussians(const std::string& name, GaussianScene scene, Log* log) {
  const std::size_t gaussians = scene.size(), bad = leaveOutBad(scene);
  const Stopwatch watch;
  GaussianSurface surface = surfaceOf(scene);
  if (log) {
    log->say(
        "{}: {}, {:.3g} apart, are the surface of {}; made in {:.0f} ms. Left out: {} faint, {} oversized, {} "
        "far from all others, {} not finite",
        name, counted(surface.cloud.size(), "point"), surface.spacing, gaussiansInWords(gaussians),
        watch.elapsed_us() * 1e-3, surface.faint, surface.oversized, surface.outlying, bad);
    if (surface.cloud.empty() && gaussians > 0) log->warn("{}: no Gaussian is visible; there is no surface", name);
  }
  StoredCloud stored{.cloud = std::move(surface.cloud)};
  const auto lose = [&](std::size_t count, std::string_view why) {
    if (count > 0) stored.lost.push_back(fmt::format("{} {}", gaussiansInWords(count), why));
  };
  lose(bad, "whose numbers are not finite or whose rotation is zero");
  lose(surface.oversized, "that are oversized");
  lose(surface.outlying, "far from all others");
  return stored;
}

}  // namespace palpate
