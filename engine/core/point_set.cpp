#include "engine/core/point_set.hpp"

#include <algorithm>
#include <utility>

namespace palpate {

PointSet PointSet::range(std::uint64_t begin, std::uint64_t end) {
  PointSet set;
  for (std::uint64_t point = begin; point < end;) {
    const std::uint64_t next = std::min(end, (point / kPage + 1) * kPage);
    Page& page = set.pages_[point / kPage];
    if (next - point == kPage) page.assign(1, kAll);
    for (; page.size() != 1 && point < next; ++point) {
      widen(page, kWords);
      page[point % kPage / kBits] |= std::uint64_t{1} << point % kBits;
    }
    point = next;
  }
  return set;
}

// A word that stands for all becomes that many.
void PointSet::widen(Page& page, std::size_t words) {
  if (page.size() < words) page.resize(words, page.empty() ? 0 : page.front());
}

void PointSet::tidy(std::map<std::uint64_t, Page>::iterator page) {
  Page& words = page->second;
  const std::uint64_t first = words.front();
  if ((first != 0 && first != kAll) || std::ranges::any_of(words, [&](std::uint64_t word) { return word != first; }))
    return;
  if (first == 0) {
    pages_.erase(page);
    return;
  }
  words.resize(1);
  words.shrink_to_fit();
}

void PointSet::set(std::uint64_t point, bool on) {
  if (test(point) == on) return;
  const auto page = pages_.try_emplace(point / kPage).first;
  widen(page->second, kWords);
  page->second[point % kPage / kBits] ^= std::uint64_t{1} << point % kBits;
  tidy(page);
}

// What takes memory comes first: it changes no point.
template <class Change>
void PointSet::change(const PointSet& other, Change&& change) {
  for (const auto& [number, page] : other.pages_) widen(pages_[number], page.size());
  for (const auto& [number, page] : other.pages_) {
    const auto own = pages_.find(number);
    for (std::uint64_t k = 0; k < own->second.size(); ++k) change(own->second[k], wordOf(page, k));
    tidy(own);
  }
}

std::vector<std::uint64_t> PointSet::bits(std::uint64_t points) const {
  std::vector<std::uint64_t> words((points + kBits - 1) / kBits);
  for (const auto& [number, page] : pages_)
    for (std::uint64_t k = 0; k < kWords && number * kWords + k < words.size(); ++k)
      words[number * kWords + k] = wordOf(page, k);
  if (points % kBits != 0) words.back() &= (std::uint64_t{1} << points % kBits) - 1;
  return words;
}

void PointSet::flip(const PointSet& other) {
  if (&other == this) return pages_.clear();
  change(other, [](std::uint64_t& own, std::uint64_t word) { own ^= word; });
}

void PointSet::add(const PointSet& other) {
  if (&other == this) return;
  change(other, [](std::uint64_t& own, std::uint64_t word) { own |= word; });
}

void PointSet::remove(const PointSet& other) {
  if (&other == this) return pages_.clear();
  change(other, [](std::uint64_t& own, std::uint64_t word) { own &= ~word; });
}

std::uint64_t PointSet::count() const {
  std::uint64_t count = 0;
  forWords([&](std::uint64_t, std::uint64_t word) { count += static_cast<std::uint64_t>(std::popcount(word)); });
  return count;
}

std::vector<PointSet::Word> PointSet::list() const {
  std::vector<Word> words;
  words.reserve(pages_.size() * kWords);
  std::uint64_t before = 0;
  forWords([&](std::uint64_t k, std::uint64_t word) {
    words.push_back({.begin = k * kBits, .bits = word, .before = before});
    before += static_cast<std::uint64_t>(std::popcount(word));
  });
  return words;
}

std::uint64_t PointSet::end() const {
  std::uint64_t end = 0;
  forWords([&](std::uint64_t k, std::uint64_t word) {
    end = (k + 1) * kBits - static_cast<std::uint64_t>(std::countl_zero(word));
  });
  return end;
}

std::uint64_t PointSet::bytes() const {
  constexpr std::uint64_t kNode = sizeof(std::pair<const std::uint64_t, Page>) + 8 * sizeof(void*);  // and two blocks
  std::uint64_t bytes = 0;
  for (const auto& page : pages_) bytes += kNode + page.second.capacity() * sizeof(std::uint64_t);
  return bytes;
}

std::vector<std::uint64_t> PointSet::words() const {
  std::vector<std::uint64_t> words{pages_.size()};
  for (const auto& [number, page] : pages_) {
    words.push_back(number);
    words.push_back(page.size());
    words.insert(words.end(), page.begin(), page.end());
  }
  return words;
}

bool PointSet::read(std::span<const std::uint64_t>& words) {
  const auto next = [&](std::uint64_t count) {
    const auto part = words.first(std::min<std::uint64_t>(count, words.size()));
    words = words.subspan(part.size());
    return part;
  };
  pages_.clear();
  const auto count = next(1);
  for (std::uint64_t i = 0; !count.empty() && i < count[0]; ++i) {
    const auto head = next(2);
    if (head.size() < 2 || (head[1] != 1 && head[1] != kWords) || head[0] > kAll / kPage - 1) return false;
    const auto page = next(head[1]);
    if (page.size() < head[1] || (!pages_.empty() && head[0] <= pages_.rbegin()->first)) return false;
    tidy(pages_.emplace_hint(pages_.end(), head[0], Page(page.begin(), page.end())));
  }
  return !count.empty();
}

}  // namespace palpate
