#pragma once

#include <bit>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

namespace palpate {

/// A set of points by number, as pages of bits: a page with none of its points takes no memory, and one with all of
/// them a word. Equal sets have equal pages.
class PointSet {
 public:
  static constexpr std::uint64_t kPage = 4096;  ///< points of a page

  PointSet() = default;
  /// The points from `begin` to before `end`.
  static PointSet range(std::uint64_t begin, std::uint64_t end);

  /// Those of a range, whose numbers numberOf() gives; cheaper than set() where they ascend.
  template <class Range, class NumberOf>
  static PointSet of(const Range& range, NumberOf&& numberOf) {
    PointSet set;
    auto page = set.pages_.end();
    for (const auto& item : range) {
      const std::uint64_t point = numberOf(item);
      if (page == set.pages_.end() || page->first != point / kPage) {
        if (page != set.pages_.end()) set.tidy(page);
        page = set.pages_.try_emplace(point / kPage).first;
        widen(page->second, kWords);
      }
      page->second[point % kPage / kBits] |= std::uint64_t{1} << point % kBits;
    }
    if (page != set.pages_.end()) set.tidy(page);
    return set;
  }

  bool test(std::uint64_t point) const {
    const auto page = pages_.find(point / kPage);
    return page != pages_.end() && (wordOf(page->second, point % kPage / kBits) >> point % kBits & 1) != 0;
  }
  void set(std::uint64_t point, bool on = true);
  bool empty() const { return pages_.empty(); }
  std::uint64_t count() const;
  /// The number after that of the last point; 0 without points.
  std::uint64_t end() const;
  /// Becomes the symmetric difference with `other`; the same call again undoes that. Keeps its points if memory is out.
  void flip(const PointSet& other);
  /// Becomes the union with `other`, or the difference from it.
  void add(const PointSet& other);
  void remove(const PointSet& other);

  /// Calls use(k, word) with the points from 64 k on, the first one in the lowest bit, for the words that are not zero,
  /// ascending.
  template <class Use>
  void forWords(Use&& use) const {
    for (const auto& [number, page] : pages_)
      for (std::uint64_t k = 0; k < kWords; ++k)
        if (const std::uint64_t word = wordOf(page, k)) use(number * kWords + k, word);
  }
  /// Calls use(point) for each point, ascending.
  template <class Use>
  void forEach(Use&& use) const {
    forWords([&](std::uint64_t k, std::uint64_t word) {
      for (; word != 0; word &= word - 1) use(k * kBits + static_cast<std::uint64_t>(std::countr_zero(word)));
    });
  }

  /// 64 points that begin at `begin`: those in `bits` are in the set, after `before` others.
  struct Word {
    std::uint64_t begin = 0, bits = 0, before = 0;

    /// Calls use(point, k) for each of them, which is the k-th of the set, ascending.
    template <class Use>
    void forEach(Use&& use) const {
      std::uint64_t k = before;
      for (std::uint64_t left = bits; left != 0; left &= left - 1)
        use(begin + static_cast<std::uint64_t>(std::countr_zero(left)), k++);
    }
  };
  /// Those with points, ascending, for many threads.
  std::vector<Word> list() const;

  /// One bit for each of the first so many points, the first one in the lowest bit; larger numbers are left out.
  std::vector<std::uint64_t> bits(std::uint64_t points) const;

  /// Memory.
  std::uint64_t bytes() const;
  /// To words for a file, and back: removes them from the front of `words`. False if they are not those of a set, or
  /// one of its points is too large a number.
  std::vector<std::uint64_t> words() const;
  bool read(std::span<const std::uint64_t>& words);

  bool operator==(const PointSet&) const = default;

 private:
  static constexpr std::uint64_t kBits = 64, kWords = kPage / kBits;
  static constexpr std::uint64_t kAll = ~std::uint64_t{0};
  using Page = std::vector<std::uint64_t>;  // kWords, or one that stands for all of them
  static std::uint64_t wordOf(const Page& page, std::uint64_t k) {
    return page.empty() ? 0 : page[page.size() == 1 ? 0 : k];
  }
  static void widen(Page& page, std::size_t words);
  template <class Change>
  void change(const PointSet& other, Change&& change);
  void tidy(std::map<std::uint64_t, Page>::iterator page);

  std::map<std::uint64_t, Page> pages_;  // by number; none is without points
};

}  // namespace palpate
