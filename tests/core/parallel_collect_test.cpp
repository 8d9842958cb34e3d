// Parallel sums, counts and selections against loops, at sizes around those at which another thread is used.
#include "engine/core/parallel_collect.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace palpate::parallel_collect_test {
namespace {

constexpr std::size_t kSizes[] = {0, 1, 2, 1023, 1024, 1025, 2047, 2048, 2049, 7 * 1024, 7 * 1024 + 1, 100'003};
constexpr unsigned kThreads[] = {0, 1, 2, 7};

std::uint32_t someNumber(std::size_t i) { return static_cast<std::uint32_t>(i * 2654435761u) >> 24; }

template <class Check>
void forAllSizes(Check&& check) {
  for (const std::size_t size : kSizes)
    for (const unsigned threads : kThreads) {
      CAPTURE(size);
      CAPTURE(threads);
      check(size, threads);
    }
}

template <class T>
bool same(const BareVector<T>& a, const std::vector<T>& b) {
  return std::ranges::equal(a, b);
}

}  // namespace

TEST_CASE("a parallel exclusive prefix sum equals the serial one and returns the total") {
  forAllSizes([](std::size_t size, unsigned threads) {
    std::vector<std::uint64_t> values(size), expected(size);
    for (std::size_t i = 0; i < size; ++i) values[i] = someNumber(i);
    std::exclusive_scan(values.begin(), values.end(), expected.begin(), std::uint64_t{0});
    const std::uint64_t total = std::accumulate(values.begin(), values.end(), std::uint64_t{0});
    CHECK(parallelSumBefore(std::span(values), threads) == total);
    CHECK(values == expected);
  });
}

TEST_CASE("a parallel selection keeps the order of its input") {
  forAllSizes([](std::size_t size, unsigned threads) {
    const auto holds = [](std::size_t i) { return someNumber(i) % 3 == 0; };
    std::vector<std::uint32_t> expected;
    for (std::size_t i = 0; i < size; ++i)
      if (holds(i)) expected.push_back(someNumber(i));
    CHECK(same(parallelCollect(size, threads, holds, someNumber), expected));
    CHECK(parallelCount(size, threads, holds) == expected.size());
    CHECK(parallelCollect(
              size, threads, [](std::size_t) { return true; }, someNumber)
              .size() == size);
    CHECK(parallelCollect(
              size, threads, [](std::size_t) { return false; }, someNumber)
              .empty());
  });
}

TEST_CASE("a parallel transform gives one result per index, in order") {
  forAllSizes([](std::size_t size, unsigned threads) {
    std::vector<std::uint32_t> expected;
    for (std::size_t i = 0; i < size; ++i) expected.push_back(someNumber(i));
    CHECK(same(parallelMake(size, threads, someNumber), expected));
  });
}

TEST_CASE("parallel run detection finds each start of a run, and the end") {
  forAllSizes([](std::size_t size, unsigned threads) {
    for (const std::size_t length : {1u, 3u, 1024u, 1'000'000u}) {
      const auto follows = [&](std::size_t i) { return i / length == (i - 1) / length; };
      std::vector<std::size_t> expected;
      for (std::size_t i = 0; i < size; i += length) expected.push_back(i);
      expected.push_back(size);
      CHECK(same(parallelRuns(size, threads, follows), expected));
    }
  });
}

TEST_CASE("a parallel reduction joins its parts in order, after the initial value") {
  forAllSizes([](std::size_t size, unsigned threads) {
    const auto list = [](std::size_t begin, std::size_t end) {
      std::vector<std::size_t> numbers(end - begin);
      std::iota(numbers.begin(), numbers.end(), begin);
      return numbers;
    };
    const auto join = [](std::vector<std::size_t> a, const std::vector<std::size_t>& b) {
      a.insert(a.end(), b.begin(), b.end());
      return a;
    };
    CHECK(parallelReduce(size, threads, std::vector<std::size_t>(), list, join) == list(0, size));
    const auto greatest = [](std::size_t begin, std::size_t end) { return begin < end ? end - 1 : 0; };
    const auto larger = [](std::size_t a, std::size_t b) { return std::max(a, b); };
    CHECK(parallelReduce(size, threads, std::size_t{5}, greatest, larger) == std::max<std::size_t>(size, 6) - 1);
  });
}

TEST_CASE("an uninitialized vector grows, copies and fills like a std::vector") {
  BareVector<std::uint32_t> values(3, 7);
  values.push_back(8);
  values.resize(6, 9);
  CHECK(same(values, {7, 7, 7, 8, 9, 9}));
  const BareVector<std::uint32_t> copy = values;
  values.resize(100'000'000 / sizeof(std::uint32_t));  // in large pages
  CHECK(reinterpret_cast<std::uintptr_t>(values.data()) % kLargePage == 0);
  values.back() = 5;
  CHECK(std::ranges::equal(copy, std::span(values).first(6)));
  BareVector<std::uint32_t> moved = std::move(values);
  CHECK(moved.back() == 5);
  moved.resize(6), moved.shrink_to_fit();
  CHECK(moved == copy);
}

}  // namespace palpate::parallel_collect_test
