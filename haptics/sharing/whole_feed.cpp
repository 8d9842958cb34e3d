#include "haptics/sharing/whole_feed.hpp"

#include <algorithm>

#include "engine/cloud/edited_cloud.hpp"

namespace palpate::sharing {

namespace {

constexpr double kMerged_s = 0.008;  // edits within this time are merged, each point once
/// Then a client gets an empty sample. On a link with losses each retransmission delays the following samples by a
/// round trip, so empty ones are rare.
constexpr double kSilence_s = 0.5;

std::uint64_t pointsFor(const Want& want, const PointCloud& cloud) {
  return (cloud.size() + want.every - 1) / want.every;
}

}  // namespace

WholeFeed::WholeFeed(const Parts& parts, const Want& want)
    : parts_(parts),
      every_(want.every),
      block_(want.first),
      blocks_(blocksOf(pointsFor(want, parts.cloud))),
      edits_(want.edits),
      // A client that starts from the beginning gets its own strokes, too.
      place_{.upTo = std::min<std::uint64_t>(want.upTo, parts.points.head()),
             .ownUpTo = want.upTo == 0 ? parts.points.head() : 0} {}

bool WholeFeed::isValid(const Want& want, const PointCloud& cloud) {
  return want.every > 0 && want.first <= blocksOf(pointsFor(want, cloud));
}

bool WholeFeed::hasNews() const {
  return parts_.points.isBehind(place_) || parts_.points.lastOf(parts_.client) != acked_;
}

bool WholeFeed::next(StreamSample& sample, const ClientStream&) {
  if (block_ < blocks_) {
    addBlock(sample);
    return true;
  }
  if (!edits_ || due_s() > 0) return false;
  addEdits(sample);
  lastSent_ = {};
  return true;
}

double WholeFeed::due_s() const {
  if (block_ < blocks_ || (edits_ && isBehind_)) return 0;
  if (!edits_) return kSilence_s;
  return (hasNews() ? kMerged_s : kSilence_s) - lastSent_.elapsed_s();
}

void WholeFeed::addBlock(StreamSample& sample) {
  const std::uint64_t points = (parts_.cloud.size() + every_ - 1) / every_;
  sample.points.resize(pointsIn(block_, points));
  for (std::size_t i = 0; i < sample.points.size(); ++i) {
    const std::size_t at = (block_ * kBlockPoints + i) * every_;
    Point& point = sample.points[i];
    for (int axis = 0; axis < 3; ++axis) {
      point.position[axis] = parts_.cloud.positions[at][axis];
      point.normal[axis] = parts_.cloud.normals[at][axis];
    }
    point.color = packedColor(parts_.cloud, at);
  }
  const auto count = static_cast<std::uint32_t>(sample.points.size());
  sample.parts.push_back({.key = block_, .total = count, .count = count, .checksum = checksumOf(sample.points)});
  ++block_;
  sample.head.last = sample.head.whole = block_ == blocks_ && !edits_;
}

// `acked` is of this moment: strokes of this client that are taken later come after the edits.
void WholeFeed::addEdits(StreamSample& sample) {
  states_.clear();
  parts_.points.collect(place_, parts_.client, kStates, states_);
  for (const PointState& point : states_) sample.states.push_back(stateOf(point));
  isBehind_ = parts_.points.isBehind(place_);
  sample.head.acked = acked_ = parts_.points.lastOf(parts_.client);
  sample.head.upTo = place_.upTo;
  sample.head.head = parts_.points.head();
  sample.head.digest = parts_.points.digest();
  sample.head.last = true;
  sample.head.whole = !isBehind_;
}

}  // namespace palpate::sharing
