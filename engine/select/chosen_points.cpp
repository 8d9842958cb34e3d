#include "engine/select/chosen_points.hpp"

#include <algorithm>
#include <cstring>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/edited_gaussians.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

template <class Values>
Values gathered(const Values& values, std::span<const std::uint32_t> numbers, unsigned threads) {
  if (values.empty()) return {};
  Values chosen(numbers.size());
  parallelFor(numbers.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) chosen[i] = values[numbers[i]];
  });
  return chosen;
}

std::vector<std::uint32_t> numbersOf(const PointSet& which) {
  std::vector<std::uint32_t> numbers(which.count());
  auto next = numbers.begin();
  which.forEach([&](std::uint64_t point) { *next++ = static_cast<std::uint32_t>(point); });
  return numbers;
}

}  // namespace

PointCloud chosenPoints(const PointCloud& cloud, const PointSet& which, unsigned threads) {
  PALPATE_CHECK_LE(which.end(), cloud.size());
  const std::vector<std::uint32_t> numbers = numbersOf(which);
  PointCloud chosen{.origin = cloud.origin,
                    .positions = gathered(cloud.positions, numbers, threads),
                    .normals = gathered(cloud.normals, numbers, threads),
                    .colors = gathered(cloud.colors, numbers, threads),
                    .exactPositions = gathered(cloud.exactPositions, numbers, threads),
                    .storedAs = cloud.storedAs};
  for (const Attribute& attribute : cloud.extra) {
    Attribute& carried = chosen.extra.emplace_back(Attribute{attribute.name, attribute.type, {}});
    const std::size_t bytes = sizeOf(attribute.type);
    carried.data.resize(numbers.size() * bytes);
    parallelFor(numbers.size(), threads, [&](std::size_t begin, std::size_t end) {
      visitScalar(attribute.type, [&]<class T>(std::type_identity<T>) {
        for (std::size_t i = begin; i < end; ++i)
          std::memcpy(carried.data.data() + i * sizeof(T), attribute.data.data() + numbers[i] * sizeof(T), sizeof(T));
      });
    });
  }
  if (gaussiansOf(cloud)) {
    std::vector<PointState> points = statesOf(cloud);
    for (PointState& point : points) point.gone = !which.test(point.number);
    chosen.storedAs.baggage = editedGaussians(cloud, points, threads);
  }
  return chosen;
}

std::vector<std::array<std::uint32_t, 3>> chosenTriangles(std::span<const std::array<std::uint32_t, 3>> triangles,
                                                          std::span<const std::uint32_t> points) {
  std::vector<std::array<std::uint32_t, 3>> chosen;
  if (triangles.empty() || points.empty()) return chosen;
  constexpr std::uint32_t kGone = ~0u;
  std::vector<std::uint32_t> numbers(std::size_t{points.back()} + 1, kGone);
  for (std::uint32_t i = 0; i < points.size(); ++i) numbers[points[i]] = i;
  for (std::array<std::uint32_t, 3> corners : triangles) {
    for (std::uint32_t& corner : corners) corner = corner < numbers.size() ? numbers[corner] : kGone;
    if (std::ranges::find(corners, kGone) == corners.end()) chosen.push_back(corners);
  }
  return chosen;
}

PointSet othersThan(const PointSet& which, std::uint64_t count) {
  PointSet others = PointSet::range(0, count);
  others.flip(which);
  return others;
}

}  // namespace palpate
