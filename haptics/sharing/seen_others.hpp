// The last message of each other client, until it times out. Independent of DDS.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "engine/core/clock.hpp"
#include "haptics/sharing/id.hpp"

namespace palpate::sharing {

/// SeenHand::number of a client's hand.
inline std::uint32_t handNumber(const Id& client, std::uint8_t hand) {
  std::uint32_t number = 0;
  std::memcpy(&number, client.data(), sizeof number);
  return number + hand;
}

/// Hands (SeenHand) or cameras (SeenCamera), at most 256. Not thread-safe.
template <class Seen>
class SeenOthers {
 public:
  /// `gone_s`: one that is silent for this long is gone.
  explicit SeenOthers(double gone_s) : gone_s_(gone_s) {}

  /// `hand`: index of the client's hand. `count`: number of its message, so that messages out of order are ignored.
  void hear(const Id& client, std::uint8_t hand, std::uint32_t count, Seen seen) {
    const std::pair key(client, hand);
    const auto known = others_.find(key);
    if (known == others_.end() ? others_.size() >= kMax : known->second.count >= count) return;
    seen.number = handNumber(client, hand);
    others_[key] = {.seen = std::move(seen), .count = count, .since = {}};
  }
  /// Removes those that are gone.
  void forget() {
    std::erase_if(others_, [&](const auto& one) { return one.second.since.elapsed_s() > gone_s_; });
  }
  /// With their current ages.
  std::vector<Seen> all() const {
    std::vector<Seen> seen;
    for (const auto& [key, other] : others_) {
      const double age_s = other.since.elapsed_s();
      if (age_s > gone_s_) continue;
      seen.push_back(other.seen);
      seen.back().age_s = age_s;
    }
    return seen;
  }

 private:
  static constexpr std::size_t kMax = 256;
  struct Other {
    Seen seen;
    std::uint32_t count = 0;
    Stopwatch since;
  };
  double gone_s_;
  std::map<std::pair<Id, std::uint8_t>, Other> others_;
};

}  // namespace palpate::sharing
