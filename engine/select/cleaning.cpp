#include "engine/select/cleaning.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <numeric>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/file_coordinates.hpp"
#include "engine/cloud/places.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/core/parallel_radix_sort.hpp"
#include "engine/select/point_bits.hpp"
#include "engine/spatial/sorted_grid.hpp"

namespace palpate {

namespace {

/// A point under a key of 64 bits.
struct KeyedPoint {
  std::uint64_t key;
  std::uint32_t point;
};

/// Calls use(points) for the points of each key, in their order; from many threads.
void forEachKey(BareVector<KeyedPoint>& entries, unsigned bits, unsigned threads, auto&& use) {
  parallelRadixSort(entries, bits, threads, [](const KeyedPoint& entry) { return entry.key; });
  const auto runs =
      parallelRuns(entries.size(), threads, [&](std::size_t i) { return entries[i].key == entries[i - 1].key; });
  parallelFor(runs.size() - 1, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t run = begin; run < end; ++run)
      use(std::span<const KeyedPoint>(entries).subspan(runs[run], runs[run + 1] - runs[run]));
  });
}

PointSet setOf(const std::vector<std::uint8_t>& truths, unsigned threads) {
  return PointBits::where(truths.size(), threads, [&](std::size_t i) { return truths[i] != 0; }).set();
}

}  // namespace

BareVector<double> neighbourDistances(const PointCloud& cloud, std::uint32_t neighbours, unsigned threads,
                                      const ShareDone& progress) {
  PALPATE_CHECK_LE(1u, neighbours);
  const Places places = distinctPlaces(cloud.positions, threads);
  const std::size_t count = places.positions.size();
  std::vector<std::uint32_t> sharing(count, 0);  // points at a position
  for (const std::uint32_t place : places.placeOf) ++sharing[place];
  const PointTree tree(places.positions, threads);
  std::vector<double> means(count);
  const std::size_t most = std::min<std::size_t>(std::size_t{neighbours} + 1, count);
  constexpr std::size_t kBlock = 1024;
  std::atomic<std::size_t> done = 0;
  parallelBlocks(count, kBlock, threads, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> near(most);
    std::vector<double> squared(most);
    NearbySearch search(tree);
    for (const std::uint32_t i : tree.order().subspan(begin, end - begin)) {
      std::size_t left = neighbours, found = std::min<std::size_t>(left, sharing[i] - 1);
      left -= found;
      double sum = 0;
      const std::size_t around = left > 0 ? search.nearest(places.positions[i], near, squared) : 0;
      for (std::size_t n = 0; n < around && left > 0; ++n) {
        if (near[n] == i) continue;
        const std::size_t taken = std::min<std::size_t>(left, sharing[near[n]]);
        sum += static_cast<double>(taken) * std::sqrt(squared[n]);
        left -= taken, found += taken;
      }
      means[i] = found > 0 ? sum / static_cast<double>(found) : 0;
    }
    done += end - begin;
    if (progress) progress(static_cast<double>(done) / static_cast<double>(count));
  });
  return parallelMake(cloud.size(), threads, [&](std::size_t i) { return means[places.placeOf[i]]; });
}

namespace {

// The same for any number of threads.
double sumOf(std::span<const double> values, unsigned threads, auto&& of) {
  constexpr std::size_t kBlock = 1 << 14;
  const auto sums = parallelMake((values.size() + kBlock - 1) / kBlock, threads, [&](std::size_t block) {
    double sum = 0;
    for (const double value : values.subspan(block * kBlock, std::min(kBlock, values.size() - block * kBlock)))
      sum += of(value);
    return sum;
  });
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

double limitOf(std::span<const double> distances, double sigma, unsigned threads) {
  const auto count = static_cast<double>(distances.size());
  const double mean = sumOf(distances, threads, std::identity()) / count;
  const double squares = sumOf(distances, threads, [&](double d) { return (d - mean) * (d - mean); });
  return mean + sigma * std::sqrt(squares / (count - 1));
}

}  // namespace

PointSet statisticalOutliers(const PointCloud& cloud, std::uint32_t neighbours, double sigma, unsigned threads,
                             const DistanceMaker& make, const ShareDone& progress) {
  if (cloud.size() < 2) return {};
  auto made = make ? make(cloud, neighbours, threads) : std::nullopt;
  if (!made) made = neighbourDistances(cloud, neighbours, threads, progress);
  const BareVector<double>& distances = *made;
  const double limit = limitOf(distances, sigma, threads);
  return PointBits::where(distances.size(), threads, [&](std::size_t i) { return distances[i] > limit; }).set();
}

std::string outlierShare(std::uint64_t outliers, std::uint64_t points) {
  constexpr double kUsual_percent = 5;
  const double share_percent = points > 0 ? 100 * static_cast<double>(outliers) / static_cast<double>(points) : 0;
  std::string words = fmt::format("{:.1f} % of the points", share_percent);
  if (share_percent > kUsual_percent) words += "; a larger sigma, such as 3, finds fewer";
  return words;
}

PointSet radiusOutliers(const PointCloud& cloud, std::uint32_t neighbours, double radius, unsigned threads) {
  PALPATE_CHECK_LT(0.0, radius);
  SortedGrid grid(makeHashGrid(Vec3(0), radius, cloud.size()), threads);
  grid.build(cloud.positions);
  const auto isOutlier = [&](std::size_t i) {
    std::size_t found = 0;  // with the point itself
    const auto goesOn = [&](std::size_t) { return found <= neighbours; };
    grid.forEachNearWhile(
        DVec3(cloud.positions[i]), radius, [&](const SortedGrid::Placed&) { ++found; }, goesOn);
    return found <= neighbours;
  };
  return PointBits::where(cloud.size(), threads, isOutlier).set();
}

PointSet duplicatePoints(const PointCloud& cloud, unsigned threads) {
  constexpr unsigned kBits = 44;  // of the hash, in four passes; points of one hash are compared
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v + 0.0); };  // -0 is 0
  auto entries = parallelMake(cloud.size(), threads, [&](std::size_t i) {
    const DVec3 p = cloud.fileCoordinates(i);
    return KeyedPoint{randomBits(randomBits(bits(p.x), bits(p.y)), bits(p.z)) >> (64 - kBits),
                      static_cast<std::uint32_t>(i)};
  });
  std::vector<std::uint8_t> repeats(cloud.size());
  forEachKey(entries, kBits, threads, [&](std::span<const KeyedPoint> points) {
    std::vector<DVec3> known;
    for (std::size_t k = 0; k < points.size() && points.size() > 1; ++k) {
      const DVec3 p = cloud.fileCoordinates(points[k].point);
      if (std::ranges::find(known, p) == known.end())
        known.push_back(p);
      else
        repeats[points[k].point] = 1;
    }
  });
  return setOf(repeats, threads);
}

PointSet onePointPerCell(const PointCloud& cloud, double side, unsigned threads) {
  PALPATE_CHECK_LT(0.0, side);
  if (cloud.empty()) return {};
  // Cells are counted from the lowest one.
  const Bounds box = boundsOf(cloud);
  const auto cellOf = [&](const DVec3& p) { return glm::floor((cloud.origin + p) / side); };
  const DVec3 low = cellOf(box.min), counts = cellOf(box.max) - low + 1.0;
  unsigned bits = 0;
  std::array<unsigned, 3> shifts{};
  for (int k = 0; k < 3; ++k) {
    constexpr double kMaxCells = 1e15;  // along an axis, for doubles to count them
    shifts[static_cast<std::size_t>(k)] = bits;
    bits += counts[k] < kMaxCells ? static_cast<unsigned>(std::bit_width(static_cast<std::uint64_t>(counts[k]))) : 64;
  }
  if (bits > 64)
    throw Error(
        "a cloud of {:.6g} x {:.6g} x {:.6g} spacings is too large to be subsampled; remove far points first, "
        "or use a larger spacing",
        counts.x, counts.y, counts.z);
  const auto placed = [&](std::size_t i) { return DVec3(cloud.positions[i]); };
  auto entries = parallelMake(cloud.size(), threads, [&](std::size_t i) {
    const DVec3 cell = cellOf(placed(i)) - low;
    std::uint64_t key = 0;
    for (std::size_t k = 0; k < 3; ++k) key |= static_cast<std::uint64_t>(cell[static_cast<int>(k)]) << shifts[k];
    return KeyedPoint{key, static_cast<std::uint32_t>(i)};
  });
  std::vector<std::uint8_t> stays(cloud.size());
  forEachKey(entries, bits, threads, [&](std::span<const KeyedPoint> points) {
    const auto fromMiddle = [&](const KeyedPoint& entry) {
      const DVec3 p = placed(entry.point), offset = cloud.origin + p - side * (cellOf(p) + 0.5);
      return glm::dot(offset, offset);
    };
    stays[std::ranges::min_element(points, {}, fromMiddle)->point] = 1;
  });
  return setOf(stays, threads);
}

PointSet randomPoints(std::uint64_t points, std::uint64_t count, std::uint64_t seed) {
  if (count >= points) return PointSet::range(0, points);
  if (count == 0) return {};
  std::vector<std::pair<std::uint64_t, std::uint64_t>> draws(points);
  for (std::uint64_t i = 0; i < points; ++i) draws[i] = {randomBits(seed, i), i};
  std::ranges::nth_element(draws, draws.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<std::uint8_t> drawn(points);
  for (std::uint64_t i = 0; i < count; ++i) drawn[draws[i].second] = 1;
  return setOf(drawn, 0);
}

}  // namespace palpate
