// Copies received before an earlier item that is still in flight.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

namespace palpate::sharing {

/// Items by their numbers in a stream, kept until all earlier ones are received, so that one lost item does not require
/// resending the following ones. Keeps at most the next kMax numbers.
template <class Item>
class EarlyCopies {
 public:
  /// `last`: all items up to this one are received.
  void keep(std::uint64_t number, std::uint64_t last, Item item) {
    if (number > last && number - last <= kMax) waiting_.insert_or_assign(number, std::move(item));
  }
  /// The item after `last`; nothing if it was not received.
  std::optional<Item> takeAfter(std::uint64_t last) {
    waiting_.erase(waiting_.begin(), waiting_.upper_bound(last));
    const auto next = waiting_.begin();
    if (next == waiting_.end() || next->first != last + 1) return std::nullopt;
    std::optional<Item> item(std::move(next->second));
    waiting_.erase(next);
    return item;
  }
  /// Drops all items: they are out of date.
  void clear() { waiting_.clear(); }
  std::size_t size() const { return waiting_.size(); }

 private:
  static constexpr std::uint64_t kMax = 64;
  std::map<std::uint64_t, Item> waiting_;
};

}  // namespace palpate::sharing
