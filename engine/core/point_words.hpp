#pragma once

#include <bit>
#include <utility>

#include "engine/core/parallel_collect.hpp"
#include "engine/core/point_set.hpp"

namespace palpate {

/// Some points of a set by words, ascending, for many threads.
struct PointWords {
  BareVector<PointSet::Word> words;
  std::uint64_t points = 0;  ///< their number
};

/// The points of the set with keep(point), which is called from many threads. Empty words may be among them.
template <class Keep>
PointWords wordsWhere(const PointSet& set, Keep&& keep) {
  const std::vector<PointSet::Word> all = set.list();
  PointWords kept{.words = parallelMake(all.size(), 0, [&](std::size_t i) {
                    PointSet::Word word{.begin = all[i].begin};
                    all[i].forEach([&](std::uint64_t point, std::uint64_t) {
                      if (keep(point)) word.bits |= std::uint64_t{1} << (point - word.begin);
                    });
                    return word;
                  })};
  for (PointSet::Word& word : kept.words)
    word.before = std::exchange(kept.points, kept.points + static_cast<std::uint64_t>(std::popcount(word.bits)));
  return kept;
}

}  // namespace palpate
