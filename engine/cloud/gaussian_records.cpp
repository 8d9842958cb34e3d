#include "engine/cloud/gaussian_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/cloud/edited_gaussians.hpp"
#include "engine/cloud/gaussian_columns.hpp"
#include "engine/cloud/gaussian_surface.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/parallel.hpp"
#include "engine/core/point_lock.hpp"

namespace palpate {

namespace {

bool isGaussian(const GaussianScene& scene, std::size_t i) {
  constexpr double kMaxCoordinate = 1e30;  // as for other clouds
  const DVec3 p = scene.centers[i];
  const bool placed =
      std::abs(p.x) < kMaxCoordinate && std::abs(p.y) < kMaxCoordinate && std::abs(p.z) < kMaxCoordinate;
  const auto isSized = [](const Vec3& v) { return std::isfinite(glm::dot(v, v)); };
  const float turn = glm::dot(scene.rotations[i], scene.rotations[i]);
  return placed && isSized(scene.logScales[i]) && turn > 0 && std::isfinite(turn) &&
         !std::isnan(scene.opacityLogits[i]) && isSized(scene.colorHarmonics[i]);
}

}  // namespace

GaussianRecords::GaussianRecords(std::vector<Column> itsColumns, BareVector<std::byte> itsRows)
    : columns(std::move(itsColumns)),
      rowBytes(columns.back().offset + sizeOf(columns.back().type)),
      rows(std::move(itsRows)) {
  format = "3DGS";
  sentence = gaussiansInWords(*this) + ", of which the points are the surface (opacity, scale, rotation";
  sentence += find("f_rest_0") ? ", colours by the direction of view)" : ")";
}

const GaussianRecords::Column* GaussianRecords::find(std::string_view name) const {
  const auto found = std::ranges::find(columns, name, [](const Column& each) { return std::string_view(each.name); });
  return found == columns.end() ? nullptr : &*found;
}

std::string gaussiansInWords(std::uint64_t count, std::size_t rest) {
  std::string words = counted(count, "Gaussian");
  for (std::size_t degree = 0; degree <= 4; ++degree)  // three channels, without the coefficients in f_dc
    if (rest == 3 * ((degree + 1) * (degree + 1) - 1)) words += fmt::format(" of degree {}", degree);
  return words;
}

std::string gaussiansInWords(const GaussianRecords& records) {
  const auto isRest = [](const GaussianRecords::Column& each) { return each.name.starts_with(kRestName); };
  return gaussiansInWords(records.size(), static_cast<std::size_t>(std::ranges::count_if(records.columns, isRest)));
}

const GaussianRecords* gaussiansOf(const PointCloud& cloud) {
  return dynamic_cast<const GaussianRecords*>(cloud.storedAs.baggage.get());
}

void forgetGaussians(PointCloud& cloud) {
  if (gaussiansOf(cloud)) cloud.storedAs.baggage.reset();
}

GaussianScene sceneOf(const GaussianRecords& records, unsigned threads) {
  const GaussianColumns columns(records);
  GaussianScene scene;
  const std::size_t count = records.size();
  scene.centers.resize(count), scene.logScales.resize(count), scene.rotations.resize(count);
  scene.opacityLogits.resize(count), scene.colorHarmonics.resize(count);
  parallelFor(count, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const std::byte* const row = records.row(i);
      scene.centers[i] = columns.center(row);
      scene.logScales[i] = columns.logScales(row);
      scene.rotations[i] = Vec4(columns.rotation(row));
      scene.opacityLogits[i] = columns.opacityLogit(row);
      scene.colorHarmonics[i] = Vec3(columns.color(row));
    }
  });
  return scene;
}

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

PointCloud surfacePointsOf(std::shared_ptr<const GaussianRecords> records, StoredAs as, unsigned threads) {
  GaussianScene scene = sceneOf(*records, threads);
  leaveOutBad(scene);
  PointCloud cloud = surfaceOf(scene, threads).cloud;
  cloud.storedAs = std::move(as);
  cloud.storedAs.baggage = std::move(records);
  addPointBytes(cloud, kLockField, threads);
  return cloud;
}

}  // namespace palpate
