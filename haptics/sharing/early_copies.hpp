// Copies that have come before one that is still under way.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

namespace palpate::sharing {

/// Items by their numbers in a stream, kept until those before them have come: of one whose copies were lost those
/// behind it do not have to be said again. No more of them than follow soon.
template <class Item>
class EarlyCopies {
 public:
  /// `last`: the one up to which all have come.
  void keep(std::uint64_t number, std::uint64_t last, Item item) {
    if (number > last && number - last <= kMax) waiting_.insert_or_assign(number, std::move(item));
  }
  /// The one that follows; nothing where it has not come.
  std::optional<Item> takeAfter(std::uint64_t last) {
    waiting_.erase(waiting_.begin(), waiting_.upper_bound(last));
    const auto next = waiting_.begin();
    if (next == waiting_.end() || next->first != last + 1) return std::nullopt;
    std::optional<Item> item(std::move(next->second));
    waiting_.erase(next);
    return item;
  }
  /// They are out of date.
  void clear() { waiting_.clear(); }
  std::size_t size() const { return waiting_.size(); }

 private:
  static constexpr std::uint64_t kMax = 64;
  std::map<std::uint64_t, Item> waiting_;
};

}  // namespace palpate::sharing
