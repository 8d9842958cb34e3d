// Large arrays that grow while they are filled: every entry is written once and kept, with any number of threads.
#include "engine/core/large_array.hpp"

#include <doctest/doctest.h>

#include <numeric>

#include "engine/core/bare_vector.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/parallel.hpp"

namespace palpate::test::large_array_test {

namespace {

/// Makes room in two steps and numbers the entries from 1, block by block, on threads that start at any block.
template <class Array, class Growing>
bool fillTwice(Array& values, Growing& growing, std::size_t first, std::size_t count, unsigned threads) {
  std::atomic<bool> wrong = false;
  const auto fill = [&](std::size_t from, std::size_t to) {
    growing.makeRoom(to);
    parallelBlocks(to - from, 777, threads, [&](std::size_t begin, std::size_t end) {
      growing.need(from + end);
      for (std::size_t i = from + begin; i < from + end; ++i) {
        if (std::is_same_v<Array, std::vector<std::uint32_t>> && values.data()[i] != 0) wrong = true;
        values.data()[i] = static_cast<std::uint32_t>(i + 1);
      }
    });
  };
  fill(0, first);
  fill(first, count);
  return !wrong;
}

template <class Array>
void checkNumbered(const Array& values, std::size_t count) {
  REQUIRE(values.size() == count);
  bool all = true;
  for (std::size_t i = 0; i < count; ++i) all = all && values[i] == i + 1;
  CHECK(all);
}

}  // namespace

TEST_CASE("an array that grows while it is filled starts with zeros, keeps its entries and ends at the right size") {
  for (const std::size_t count :
       {std::size_t{0}, std::size_t{1}, std::size_t{1000}, std::size_t{524'288}, std::size_t{6'000'001}})
    for (const unsigned threads : {1u, 2u, 16u})
      for (const bool reserved : {false, true}) {
        CAPTURE(count);
        CAPTURE(threads);
        CAPTURE(reserved);
        std::vector<std::uint32_t> values;
        BareVector<std::uint32_t> bare;
        if (reserved) reserveLarge(values, count);
        const Stopwatch watch;
        GrowingArray growing(values);
        GrowingArray growingBare(bare);
        CHECK(fillTwice(values, growing, count / 3, count, threads));
        fillTwice(bare, growingBare, count / 3, count, threads);
        checkNumbered(values, count);
        checkNumbered(bare, count);
        CHECK(growing.waited_s() <= threads * watch.elapsed_s());
        if (threads == 1) CHECK(growing.waited_s() == 0);  // no other thread to wait for
      }
}

TEST_CASE("an array grows only as far as needed, within its reserved room, and never shrinks") {
  std::vector<std::uint32_t> values{7, 8, 9};
  GrowingArray growing(values);
  growing.need(0);
  CHECK(values.size() == 3);
  growing.makeRoom(2);
  growing.need(2);
  CHECK(values == std::vector<std::uint32_t>{7, 8, 9});
  growing.makeRoom(10'000'000);
  growing.need(4);
  CHECK(values.size() >= 4);
  CHECK(values.size() < 10'000'000);  // memory grows with the need
  CHECK(values[2] == 9);
  growing.need(10'000'000);
  CHECK(values.size() == 10'000'000);
  CHECK(std::accumulate(values.begin(), values.end(), std::uint64_t{0}) == 24);
}

}  // namespace palpate::test::large_array_test
