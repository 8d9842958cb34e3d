// Sorting into buckets, compared with a stable sort.
#include "engine/core/bucket_sort.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

namespace palpate::bucket_sort_test {

namespace {

struct Case {
  std::size_t count;
  std::uint32_t buckets;
  std::uint32_t leavesOut;  // one of so many items; 0: none
};

void checkSorts(BucketSort<std::uint32_t>& sort, const Case& given, WorkerTeam& team) {
  CAPTURE(given.count);
  CAPTURE(given.buckets);
  CAPTURE(team.size());
  std::mt19937 random(5);
  std::vector<std::uint32_t> buckets(given.count), expected;
  for (std::uint32_t& bucket : buckets)
    bucket = given.leavesOut != 0 && random() % given.leavesOut == 0 ? kNoBucket : random() % given.buckets;
  for (std::uint32_t i = 0; i < given.count; ++i)
    if (buckets[i] != kNoBucket) expected.push_back(i);
  std::ranges::stable_sort(expected, {}, [&](std::uint32_t i) { return buckets[i]; });
  sort.sort(
      given.count, team, [&](std::size_t i) { return buckets[i]; },
      [](std::size_t i, std::uint32_t& item) { item = static_cast<std::uint32_t>(i); });
  CHECK(std::ranges::equal(sort.items(), expected));
  REQUIRE(sort.starts().size() == std::size_t{given.buckets} + 1);
  std::size_t wrong = 0, first = 0;
  for (std::uint32_t bucket = 0; bucket < given.buckets; ++bucket) {
    wrong += sort.starts()[bucket] != first;
    while (first < expected.size() && buckets[expected[first]] == bucket) ++first;
  }
  CHECK(wrong == 0);
  CHECK(sort.starts().back() == expected.size());
}

}  // namespace

TEST_CASE("items are sorted into any number of buckets in their order, with any number of threads") {
  for (const unsigned threads : {1u, 2u, 5u}) {
    WorkerTeam team(threads);
    for (const std::uint32_t buckets : {1u, 2u, 3u, 64u, 65u, 100'003u})
      for (const std::size_t count : {0u, 1u, 100u, 8191u, 50'000u}) {
        BucketSort<std::uint32_t> sort(buckets);
        checkSorts(sort, {count, buckets, 0}, team);
      }
  }
}

TEST_CASE("items in no bucket are left out of a sort, and a sort after another one depends only on its own items") {
  WorkerTeam many(3), one(1);
  BucketSort<std::uint32_t> sort(1000);
  checkSorts(sort, {60'000, 1000, 3}, many);
  checkSorts(sort, {20'000, 1000, 1}, one);
  checkSorts(sort, {30'000, 1000, 7}, many);
}

}  // namespace palpate::bucket_sort_test
