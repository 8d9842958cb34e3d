// Large arrays that grow while they are filled: every entry once, none lost, whatever the number of threads.
#include "engine/core/large_array.hpp"

#include <doctest/doctest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>

namespace palpate::test {

TEST_CASE("arrays that grow keep what is there, and have zeros behind it") {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{1000}, std::size_t{6'000'001}})
    for (const unsigned threads : {1u, 3u}) {
      CAPTURE(count);
      CAPTURE(threads);
      std::vector<std::uint32_t> values{7, 8, 9};
      values.reserve(5);
      resizeLarge(values, count, threads);
      REQUIRE(values.size() == std::max<std::size_t>(count, 3));  // it does not shrink
      CHECK(values[0] == 7);
      CHECK(values[2] == 9);
      CHECK(std::all_of(values.begin() + 3, values.end(), [](std::uint32_t v) { return v == 0; }));
    }
}

TEST_CASE("what is filled while it grows is filled once, after it has grown") {
  for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{65'535}, std::size_t{65'536},
                                  std::size_t{65'537}, std::size_t{1'000'003}})
    for (const unsigned threads : {1u, 2u, 16u})
      for (const bool reserved : {false, true}) {
        CAPTURE(count);
        CAPTURE(threads);
        CAPTURE(reserved);
        std::vector<std::uint32_t> numbers;
        std::vector<std::uint8_t> times;
        if (reserved) reserveLarge(numbers, count);
        std::atomic<bool> early = false;
        growAndFill(
            count, threads,
            [&](std::size_t to, Jobs& jobs) {
              addGrowth(numbers, to, jobs);
              addGrowth(times, to, jobs);
            },
            [&](std::size_t begin, std::size_t end) {
              for (std::size_t i = begin; i < end; ++i) {
                if (numbers[i] != 0 || times[i] != 0) early = true;
                numbers[i] = static_cast<std::uint32_t>(i + 1);
                ++times[i];
              }
            });
        REQUIRE(numbers.size() == count);
        REQUIRE(times.size() == count);
        CHECK(!early);
        std::vector<std::uint32_t> expected(count);
        std::iota(expected.begin(), expected.end(), 1u);
        CHECK((numbers == expected));
        CHECK(std::all_of(times.begin(), times.end(), [](std::uint8_t t) { return t == 1; }));
      }
}

TEST_CASE("jobs and blocks are each done once, and what one of them throws comes out") {
  for (const unsigned threads : {1u, 2u, 16u}) {
    std::vector<int> done(20, 0), seen(1003, 0);
    Jobs jobs;
    for (std::size_t k = 0; k < done.size(); ++k) jobs.emplace_back([&, k] { ++done[k]; });
    parallelBlocksBeside(jobs, seen.size(), 100, threads, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++seen[i];
    });
    CHECK(done == std::vector<int>(20, 1));
    CHECK(seen == std::vector<int>(1003, 1));
    jobs.emplace_back([] { throw std::runtime_error("no"); });
    CHECK_THROWS_AS(doTogether(jobs, threads), std::runtime_error);
  }
}

}  // namespace palpate::test
