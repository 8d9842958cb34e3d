// Which samples go a few times more, over a way on which they may be lost, beside the reliable one that they have gone:
// what one of the ways loses costs no round trip then. Nothing of DDS is seen here.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <limits>
#include <utility>

namespace palpate::sharing {

/// Bytes that may be said: so many a second, and as many at once as a fifth of a second brings.
class ByteBudget {
 public:
  explicit ByteBudget(double bytes_per_s) : rate_(bytes_per_s), left_(kAtOnce_s * bytes_per_s) {}
  void setRate(double bytes_per_s) { rate_ = bytes_per_s; }
  /// They were said, whether or not there was room for them.
  void spend(std::size_t bytes, double now_s);
  /// Takes them where they are there.
  bool take(std::size_t bytes, double now_s);

 private:
  static constexpr double kAtOnce_s = 0.2;
  void fill(double now_s);

  double rate_, left_, filled_s_ = 0;
};

/// Items in the order of a stream, each due four times within 70 ms of the moment at which it was said. What the budget
/// has no room for is left out, and what is said the reliable way spends it, too: where much is said, little of it goes
/// again.
template <class Item>
class CopySchedule {
 public:
  explicit CopySchedule(double bytes_per_s) : budget_(bytes_per_s) {}
  void setRate(double bytes_per_s) { budget_.setRate(bytes_per_s); }

  /// It was said the reliable way just now.
  void add(Item item, std::size_t bytes, double now_s) {
    budget_.spend(bytes, now_s);
    entries_.push_back({std::move(item), bytes, now_s});
    if (entries_.size() > kMax) entries_.pop_front();
  }
  /// Those that were said are out of date.
  void clear() { entries_.clear(); }
  /// Gives `say` each item that is due, in order.
  template <class Say>
  void sayDue(double now_s, Say&& say) {
    for (Entry& entry : entries_) {
      if (now_s < entry.due_s()) continue;
      if (budget_.take(entry.bytes, now_s)) {
        say(entry.item);
        ++entry.said;
      } else {
        entry.said = kAfter_s.size();
      }
    }
    std::erase_if(entries_, [](const Entry& entry) { return entry.said == kAfter_s.size(); });
  }
  /// After so many seconds the next one is due; infinity where there is none.
  double next_s(double now_s) const {
    double next_s = std::numeric_limits<double>::infinity();
    for (const Entry& entry : entries_) next_s = std::min(next_s, std::max(0.0, entry.due_s() - now_s));
    return next_s;
  }

 private:
  static constexpr std::array<double, 4> kAfter_s{0, 0.010, 0.030, 0.070};  // apart, since losses come in bursts
  static constexpr std::size_t kMax = 64;
  struct Entry {
    Item item;
    std::size_t bytes;
    double begun_s;
    std::size_t said = 0;  // times
    double due_s() const { return begun_s + kAfter_s[said]; }
  };

  ByteBudget budget_;
  std::deque<Entry> entries_;
};

}  // namespace palpate::sharing
