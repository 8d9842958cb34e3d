// Sends samples a few more times over a best-effort path, beside the reliable one, so that a loss on one of the paths
// costs no round trip. Independent of DDS.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <deque>
#include <limits>
#include <utility>

namespace palpate::sharing {

/// Byte budget: a rate, and bursts of at most what a fifth of a second brings.
class ByteBudget {
 public:
  explicit ByteBudget(double bytes_per_s) : rate_(bytes_per_s), left_(kAtOnce_s * bytes_per_s) {}
  void setRate(double bytes_per_s) { rate_ = bytes_per_s; }
  /// The bytes were sent, whether or not the budget covered them.
  void spend(std::size_t bytes, double now_s);
  /// Spends the bytes if the budget covers them; otherwise returns false.
  bool take(std::size_t bytes, double now_s);

 private:
  static constexpr double kAtOnce_s = 0.2;
  void fill(double now_s);

  double rate_, left_, filled_s_ = 0;
};

/// Items in the order of a stream, each due four times within 70 ms of its reliable transmission. Copies beyond the
/// budget are dropped. Reliable transmissions spend the budget, too: under load few copies are sent.
template <class Item>
class CopySchedule {
 public:
  explicit CopySchedule(double bytes_per_s) : budget_(bytes_per_s) {}
  void setRate(double bytes_per_s) { budget_.setRate(bytes_per_s); }

  /// The item was just sent on the reliable path.
  void add(Item item, std::size_t bytes, double now_s) {
    budget_.spend(bytes, now_s);
    entries_.push_back({std::move(item), bytes, now_s});
    if (entries_.size() > kMax) entries_.pop_front();
  }
  /// Drops all items: they are out of date.
  void clear() { entries_.clear(); }
  /// Passes each item that is due to `say`, in order.
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
  /// Seconds until the next item is due; infinity if there is none.
  double next_s(double now_s) const {
    double next_s = std::numeric_limits<double>::infinity();
    for (const Entry& entry : entries_) next_s = std::min(next_s, std::max(0.0, entry.due_s() - now_s));
    return next_s;
  }

 private:
  static constexpr std::array<double, 4> kAfter_s{0, 0.010, 0.030, 0.070};  // spread, since losses come in bursts
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
