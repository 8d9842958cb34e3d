#include "haptics/sharing/shared_points.hpp"

#include <algorithm>

#include "engine/core/vec.hpp"

namespace palpate::sharing {

namespace {

constexpr std::size_t kMaxPointClients = 4096;  // whose last taken pieces are known
constexpr std::size_t kMinOrder = 1 << 20;      // entries of the order that are kept
constexpr float kLongestNormal = 1.01F;

}  // namespace

bool isWhole(const PointState& state, std::size_t points) {
  return state.number < points && isFinite(DVec3(state.position)) && glm::length(state.normal) < kLongestNormal;
}

SharedPoints::SharedPoints(std::vector<PointState> points)
    : points_(std::move(points)),
      last_(points_.size()),
      mostOrder_(std::max(kMinOrder, 2 * points_.size())),
      digest_(points_) {}

SharedPoints::Taken SharedPoints::take(const Id& client, std::uint64_t number, std::span<const PointState> states,
                                       std::span<const std::uint64_t> replaced) {
  const auto found = clients_.find(client);
  const std::uint64_t last = found == clients_.end() ? 0 : found->second.last;
  if (number <= last) return Taken::known;
  if (number != last + 1) return Taken::early;
  if (states.empty() || (!replaced.empty() && replaced.size() != states.size())) return Taken::refused;
  if (!std::ranges::all_of(states, [&](const PointState& s) { return isWhole(s, points_.size()); }))
    return Taken::refused;
  if (found == clients_.end() && clients_.size() >= kMaxPointClients) return Taken::refused;
  Client& own = clients_[client];
  if (own.number == 0) own.number = static_cast<std::uint32_t>(clients_.size());
  own.last = number;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const std::uint32_t point = states[i].number;
    PointState& present = points_[point];
    const std::uint64_t was = PointDigest::of(present);
    const bool stands = replaced.empty() || was == replaced[i];
    if (stands) {
      digest_.replace(present, states[i]);
      present = states[i];
      present.parent = point;
    }
    order_.push_back(point);
    last_[point] = {.number = head(), .client = PointDigest::of(present) == was ? 0 : own.number};
  }
  while (order_.size() > mostOrder_) {
    order_.pop_front();
    ++first_;
  }
  return Taken::taken;
}

std::uint64_t SharedPoints::lastOf(const Id& client) const {
  const auto found = clients_.find(client);
  return found == clients_.end() ? 0 : found->second.last;
}

void SharedPoints::scan(Place& place, std::uint32_t receiver, std::size_t end, std::vector<PointState>& states) const {
  if (place.scanEnd == 0) {
    place.scanEnd = head();
    place.scanned = 0;
  }
  for (; place.scanned < points_.size() && states.size() < end; ++place.scanned) {
    const Last& last = last_[place.scanned];
    const bool isOwn = last.client == receiver && last.number > place.ownUpTo;
    if (last.number > place.upTo && !isOwn) states.push_back(points_[place.scanned]);
  }
  if (place.scanned < points_.size()) return;
  place.upTo = place.scanEnd;
  place.scanEnd = place.scanned = 0;
}

void SharedPoints::collect(Place& place, const Id& receiver, std::size_t most, std::vector<PointState>& states) const {
  const auto found = clients_.find(receiver);
  const std::uint32_t own = found == clients_.end() ? ~std::uint32_t{0} : found->second.number;
  const std::size_t end = states.size() + most;
  if (place.scanEnd != 0 || place.upTo + 1 < first_) return scan(place, own, end, states);
  for (; place.upTo < head() && states.size() < end; ++place.upTo) {
    const std::uint64_t number = place.upTo + 1;
    const std::uint32_t point = order_[number - first_];
    const Last& last = last_[point];
    // Given once, at its last number.
    if (last.number == number && !(last.client == own && number > place.ownUpTo)) states.push_back(points_[point]);
  }
}

}  // namespace palpate::sharing
