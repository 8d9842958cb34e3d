// The radix sort against std::stable_sort, and the value of a rank against the sorted values.
#include "engine/core/parallel_radix_sort.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <random>

namespace palpate::parallel_radix_sort_test {
namespace {

constexpr std::size_t kSizes[] = {0, 1, 2, 1023, 1024, 1025, 2049, 100'003};
constexpr unsigned kThreads[] = {0, 1, 2, 7};

struct Numbered {
  std::uint64_t key;
  std::uint32_t number;
  bool operator==(const Numbered&) const = default;
};

}  // namespace

TEST_CASE("a radix sort sorts by the given bits and is stable") {
  std::mt19937_64 random(5);
  for (const std::size_t size : kSizes)
    for (const unsigned bits : {0u, 1u, 7u, 8u, 9u, 31u, 63u, 64u}) {
      CAPTURE(size);
      CAPTURE(bits);
      BareVector<Numbered> values(size);
      for (std::uint32_t i = 0; i < size; ++i) values[i] = {random(), i};
      const auto keyOf = [&](const Numbered& value) { return bits < 64 ? value.key % (1ull << bits) : value.key; };
      BareVector<Numbered> expected = values;
      std::ranges::stable_sort(expected, {}, keyOf);
      for (const unsigned threads : kThreads) {
        BareVector<Numbered> sorted = values;
        parallelRadixSort(sorted, bits, threads, [](const Numbered& value) { return value.key; });
        CHECK(std::ranges::equal(sorted, expected));
      }
    }
}

TEST_CASE("the value of a rank equals the one at that index after sorting") {
  constexpr float kMax = std::numeric_limits<float>::max(), kInfinity = std::numeric_limits<float>::infinity();
  std::mt19937_64 random(6);
  std::normal_distribution<float> normal(0.5f, 2);
  for (const std::size_t size : kSizes) {
    std::vector<float> values(size);
    for (float& value : values) value = normal(random);
    for (std::size_t i = 0; i < size; i += 50) values[i] = 1;
    if (size > 1000) values[3] = kMax, values[500] = -kMax, values[7] = -kInfinity, values[900] = kInfinity;
    std::vector<float> sorted = values;
    std::ranges::sort(sorted);
    for (const unsigned threads : kThreads)
      for (const std::size_t rank : {std::size_t{0}, size / 3, size / 2, size - 1})
        if (rank < size) CHECK(parallelNth(values, rank, threads) == sorted[rank]);
  }
}

}  // namespace palpate::parallel_radix_sort_test
