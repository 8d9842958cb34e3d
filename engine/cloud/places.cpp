#include "engine/cloud/places.hpp"

#include <algorithm>
#include <bit>

#include "engine/core/check.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/core/parallel_radix_sort.hpp"
#include "engine/core/stop_checks.hpp"

namespace palpate {
namespace {

struct Entry {
  Vec3 position;
  std::uint32_t point;
};

// In the order of the numbers; 0 and -0 are equal.
std::uint32_t orderedBits(float value) {
  constexpr std::uint32_t kSign = 0x80000000;
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.0f);
  return bits & kSign ? ~bits : bits | kSign;
}

// By x at first, with all threads, and then those of the same x.
BareVector<Entry> sorted(std::span<const Vec3> points, unsigned threads) {
  auto entries = parallelMake(points.size(), threads, [&](std::size_t i) {
    return Entry{points[i], static_cast<std::uint32_t>(i)};
  });
  parallelRadixSort(entries, 32, threads, [](const Entry& entry) { return orderedBits(entry.position.x); });
  const auto runs = parallelRuns(entries.size(), threads,
                                 [&](std::size_t i) { return entries[i].position.x == entries[i - 1].position.x; });
  parallelFor(runs.size() - 1, threads, [&](std::size_t begin, std::size_t end) {
    StopChecks checks;
    for (std::size_t k = begin; k < end; ++k)
      std::sort(entries.begin() + static_cast<std::ptrdiff_t>(runs[k]),
                entries.begin() + static_cast<std::ptrdiff_t>(runs[k + 1]), [&](const Entry& a, const Entry& b) {
                  checks();
                  if (a.position.y != b.position.y) return a.position.y < b.position.y;
                  return a.position.z != b.position.z ? a.position.z < b.position.z : a.point < b.point;
                });
  });
  return entries;
}

}  // namespace

Places distinctPlaces(std::span<const Vec3> points, unsigned threads) {
  PALPATE_CHECK_LT(points.size(), std::size_t{1} << 32);
  const BareVector<Entry> entries = sorted(points, threads);
  const auto runs = parallelRuns(entries.size(), threads,
                                 [&](std::size_t i) { return entries[i].position == entries[i - 1].position; });
  Places places{std::vector<Vec3>(runs.size() - 1), BareVector<std::uint32_t>(points.size())};
  parallelFor(places.positions.size(), threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t place = begin; place < end; ++place) {
      places.positions[place] = entries[runs[place]].position;
      for (std::size_t i = runs[place]; i < runs[place + 1]; ++i)
        places.placeOf[entries[i].point] = static_cast<std::uint32_t>(place);
    }
  });
  return places;
}

}  // namespace palpate
