#include "engine/select/gaussian_centers.hpp"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "engine/cloud/gaussian_columns.hpp"
#include "engine/core/parallel.hpp"
#include "engine/select/move_points.hpp"

namespace palpate {

namespace {

std::array<std::uint8_t, 4> colorOf(const DVec3& harmonic) {
  const DVec3 color = 255.0 * glm::clamp(0.5 + kZeroHarmonic * harmonic, 0.0, 1.0) + 0.5;
  return {static_cast<std::uint8_t>(color.r), static_cast<std::uint8_t>(color.g), static_cast<std::uint8_t>(color.b),
          255};
}

bool isCoordinate(const GaussianRecords::Column& column) {
  return column.name == "x" || column.name == "y" || column.name == "z";
}

/// By which number all coordinates were multiplied, whatever was added; 1 if there is no such number.
double scaleBetween(std::span<const DVec3> before, std::span<const DVec3> after) {
  constexpr double kRounding = 1e-5;  // of the longest side
  if (before.empty()) return 1;
  Bounds from{before[0], before[0]}, to{after[0], after[0]};
  for (std::size_t i = 0; i < before.size(); ++i) {
    from = {glm::min(from.min, before[i]), glm::max(from.max, before[i])};
    to = {glm::min(to.min, after[i]), glm::max(to.max, after[i])};
  }
  if (!(from.longestSide() > 0)) return 1;
  const double scale = to.longestSide() / from.longestSide();
  const auto fits = [&](std::size_t i) {
    const DVec3 off = glm::abs(after[i] - to.min - scale * (before[i] - from.min));
    return std::max({off.x, off.y, off.z}) <= kRounding * to.longestSide();
  };
  for (std::size_t i = 0; i < before.size(); ++i)
    if (!fits(i)) return 1;
  return std::abs(scale - 1) > kRounding ? scale : 1;
}

}  // namespace

GaussianCenters centersOf(const GaussianRecords& records, bool withAttributes, unsigned threads) {
  const GaussianColumns columns(records);
  GaussianCenters centers;
  PointCloud& cloud = centers.cloud;
  std::vector<DVec3> coordinates;
  for (std::uint32_t i = 0; i < records.size(); ++i) {
    const DVec3 center = columns.center(records.row(i));
    if (!isFinite(Vec3(center))) continue;
    centers.numbers.push_back(i);
    coordinates.push_back(center);
    cloud.colors.push_back(colorOf(columns.color(records.row(i))));
  }
  cloud.positions.resize(coordinates.size());
  cloud.storedAs.position = records.find("x")->type;
  movePoints(cloud, coordinates);
  for (const GaussianRecords::Column& column : records.columns) {
    if (!withAttributes || isCoordinate(column)) continue;
    const std::size_t bytes = sizeOf(column.type);
    Attribute& attribute = cloud.extra.emplace_back(Attribute{column.name, column.type, {}});
    attribute.data.resize(bytes * cloud.size());
    parallelFor(cloud.size(), threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        std::memcpy(attribute.data.data() + i * bytes, records.row(centers.numbers[i]) + column.offset, bytes);
    });
  }
  return centers;
}

std::shared_ptr<const GaussianRecords> changedGaussians(const GaussianRecords& records, const GaussianCenters& centers,
                                                        const PointCloud& points,
                                                        std::span<const std::uint32_t> numbers, unsigned threads) {
  std::vector<GaussianRecords::Column> all = records.columns;
  std::size_t rowBytes = records.rowBytes;
  for (const Attribute& attribute : points.extra)
    if (!records.find(attribute.name)) {
      all.push_back({attribute.name, attribute.type, rowBytes});
      rowBytes += sizeOf(attribute.type);
    }
  std::vector<std::size_t> offsets;  // of the attributes
  for (const Attribute& attribute : points.extra)
    offsets.push_back(std::ranges::find(all, attribute.name, &GaussianRecords::Column::name)->offset);
  std::vector<DVec3> before(points.size()), after(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    before[i] = centers.cloud.fileCoordinates(numbers[i]), after[i] = points.fileCoordinates(i);
  const double scale = scaleBetween(before, after);
  const GaussianColumns columns(records);  // which have the same positions in the new rows
  BareVector<std::byte> rows(points.size() * rowBytes);
  parallelFor(points.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      std::byte* const row = rows.data() + i * rowBytes;
      std::memcpy(row, records.row(centers.numbers[numbers[i]]), records.rowBytes);
      for (std::size_t k = 0; k < offsets.size(); ++k) {
        const std::size_t bytes = sizeOf(points.extra[k].type);
        std::memcpy(row + offsets[k], points.extra[k].data.data() + i * bytes, bytes);
      }
      if (after[i] != before[i]) columns.setCenter(row, after[i]);
      if (scale != 1) columns.scale(row, std::log(scale));
      if (points.colors[i] != centers.cloud.colors[numbers[i]]) columns.paint(row, points.colors[i]);
    }
  });
  return std::make_shared<const GaussianRecords>(std::move(all), std::move(rows));
}

}  // namespace palpate
