#include "haptics/sharing/client_stream.hpp"

#include <algorithm>

namespace palpate::sharing {

namespace {

constexpr std::uint64_t kFirstWindow = 256;  // samples in flight at first; grows by each acknowledged one
constexpr double kProbe_s = 1;               // without progress

}  // namespace

void StreamSample::clear() {
  head = {};
  parts.clear();
  ids.clear();
  points.clear();
  velocities.clear();
  forces = {};
  states.clear();
}

const Points& StreamSample::given() {
  give(head.parts, parts);
  give(head.ids, ids);
  give(head.points, points);
  give(head.velocities, velocities);
  give(head.states, states);
  if (forces != HandsForces{}) give(head.forces, forces);
  return head;
}

ClientStream::ClientStream(const Participant& participant, const Topics& topics, const Id& session, const Id& client)
    : session_(session),
      writer_(participant, topics.points, reliableQos(false, partitionOf(client))),
      window_(kFirstWindow) {}

ClientStream::Asked ClientStream::take(const Want& want) {
  heard_ = {};
  if (want.epoch < epoch_ || (want.epoch == epoch_ && want.number <= number_)) return Asked::old;
  number_ = want.number;
  if (want.epoch == epoch_) {
    acknowledge(want.taken);
    return Asked::known;
  }
  epoch_ = want.epoch;
  // A client with samples of an epoch unknown here was removed, or has them from the previous server. The next sample
  // it gets does not follow those, so it requests everything again.
  sample_ = taken_ = want.taken > 0 ? want.taken + 1 : 0;
  window_ = kFirstWindow;
  holds_ = false;
  unacked_.clear();
  return Asked::fresh;
}

void ClientStream::acknowledge(std::uint64_t taken) {
  if (taken <= taken_ || taken > sample_) return;
  window_ += taken - taken_;
  taken_ = taken;
  progressed_ = {};
  while (!unacked_.empty() && unacked_.front().sample <= taken) {
    fastest_s_ = std::min(fastest_s_, unacked_.front().since.elapsed_s());
    unacked_.pop_front();
  }
}

bool ClientStream::keepsUp() const {
  constexpr double kSlack_s = 0.06;
  return unacked_.empty() || unacked_.front().since.elapsed_s() < 1.5 * fastest_s_ + kSlack_s;
}

bool ClientStream::write() {
  set(held_.head.session, session_);
  held_.head.epoch = epoch_;
  held_.head.sample = sample_ + 1;
  if (!writer_.write(held_.given())) return false;
  holds_ = false;
  stated_ = held_.head;
  if (sample_ == taken_) progressed_ = {};
  ++sample_;
  if (held_.head.last) unacked_.push_back({.sample = sample_, .since = {}});
  return true;
}

void ClientStream::probe() {
  if (isAcknowledged() || holds_ || progressed_.elapsed_s() < kProbe_s) return;
  held_.clear();
  held_.head.acked = stated_.acked;
  held_.head.upTo = stated_.upTo;
  held_.head.head = stated_.head;
  held_.head.digest = stated_.digest;
  holds_ = true;
  write();
  progressed_ = {};
}

}  // namespace palpate::sharing
