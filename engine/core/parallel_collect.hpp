// Sums, counts and selections over large arrays with many threads. Results do not depend on the number of threads.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "engine/core/bare_vector.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

/// join(...join(join(start, a), b)..., z), where a to z are the results of body(begin, end) on disjoint ranges that
/// cover [0, count), in their order. `join` must be exact, as for integers, minima and maxima: the ranges depend on
/// `threads`.
template <class T, class Body, class Join>
T parallelReduce(std::size_t count, unsigned threads, T start, Body&& body, Join&& join) {
  const ParallelRanges ranges(count, threads);
  std::vector<T> parts(ranges.count(), start);
  parallelParts(ranges.count(), [&](std::size_t k) { parts[k] = body(ranges.begin(k), ranges.end(k)); });
  for (const T& part : parts) start = join(start, part);
  return start;
}

/// Number of i in [0, count) with holds(i).
template <class Holds>
std::size_t parallelCount(std::size_t count, unsigned threads, Holds&& holds) {
  const auto countIn = [&](std::size_t begin, std::size_t end) {
    std::size_t found = 0;
    for (std::size_t i = begin; i < end; ++i) found += holds(i) ? 1 : 0;
    return found;
  };
  return parallelReduce(count, threads, std::size_t{0}, countIn, std::plus<>());
}

/// Exclusive prefix sum in place, of integers; returns the total.
template <class T>
T parallelSumBefore(std::span<T> values, unsigned threads) {
  const ParallelRanges ranges(values.size(), threads);
  std::vector<T> sums(ranges.count(), 0);
  parallelParts(ranges.count(), [&](std::size_t k) {
    T sum = 0;
    for (std::size_t i = ranges.begin(k); i < ranges.end(k); ++i) sum += values[i];
    sums[k] = sum;
  });
  T total = 0;
  for (T& sum : sums) total += std::exchange(sum, total);
  parallelParts(ranges.count(), [&](std::size_t k) {
    T sum = sums[k];
    for (std::size_t i = ranges.begin(k); i < ranges.end(k); ++i) sum += std::exchange(values[i], sum);
  });
  return total;
}

/// make(i) of every i in [0, count) with keep(i), in the order of i. Both are called from many threads, keep(i) twice.
template <class Keep, class Make>
auto parallelCollect(std::size_t count, unsigned threads, Keep&& keep, Make&& make) {
  const ParallelRanges ranges(count, threads);
  std::vector<std::size_t> places(ranges.count());
  parallelParts(ranges.count(), [&](std::size_t k) {
    std::size_t kept = 0;
    for (std::size_t i = ranges.begin(k); i < ranges.end(k); ++i) kept += keep(i) ? 1 : 0;
    places[k] = kept;
  });
  std::size_t total = 0;
  for (std::size_t& place : places) total += std::exchange(place, total);
  BareVector<std::remove_cvref_t<std::invoke_result_t<Make&, std::size_t>>> made(total);
  parallelParts(ranges.count(), [&](std::size_t k) {
    std::size_t place = places[k];
    for (std::size_t i = ranges.begin(k); i < ranges.end(k); ++i)
      if (keep(i)) made[place++] = make(i);
  });
  return made;
}

/// Start indices of the runs of [0, count), followed by their end: follows(i) says whether i is in the run of i - 1. If
/// count is 0 there are no runs, and the result is the end alone.
template <class Follows>
BareVector<std::size_t> parallelRuns(std::size_t count, unsigned threads, Follows&& follows) {
  return parallelCollect(
      count + 1, threads, [&](std::size_t i) { return i == 0 || i == count || !follows(i); },
      [](std::size_t i) { return i; });
}

/// make(i) of every i in [0, count), in order.
template <class Make>
auto parallelMake(std::size_t count, unsigned threads, Make&& make) {
  BareVector<std::remove_cvref_t<std::invoke_result_t<Make&, std::size_t>>> made(count);
  parallelFor(count, threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) made[i] = make(i);
  });
  return made;
}

}  // namespace palpate
