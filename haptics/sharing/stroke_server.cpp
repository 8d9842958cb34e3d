#include "haptics/sharing/stroke_server.hpp"

#include <algorithm>
#include <utility>

namespace palpate::sharing {

namespace {

constexpr std::size_t kMaxStrokeFollowers = 64;  // at a time; one more replaces the client that was silent for longest,
constexpr double kWriterTimeout_s = 5;           // if it was silent for this long: followers ping
constexpr std::int32_t kMaxSamples = 32'768;     // of each kind, 1.4 KB each; dropped ones are sent again
constexpr std::uint32_t kMaxResults = 2048;      // kept for a follower that may not have them yet
constexpr double kApart_s = 0.008;               // edits within this time are merged, each point once
/// Then a follower gets an empty result. On a link with losses each retransmission delays the following results by a
/// round trip, so empty ones are rare.
constexpr double kSilence_s = 0.5;
constexpr int kInTurn = 64;  // results for one follower before the next one has its turn

}  // namespace

StrokeServer::StrokeServer(const Parts& parts)
    : parts_(parts),
      strokes_(parts.participant, parts.topics.strokes, keepingLast(reliableQos(false), kMaxSamples)),
      resumes_(parts.participant, parts.topics.resumes, keepingLast(reliableQos(false), kMaxSamples)) {
  counts_.sculptors = parts_.points.clients();
  counts_.states = parts_.points.head();
  if (parts_.journal) counts_.pieces = parts_.journal->pieces();
}

void StrokeServer::attach(ReaderWait& wait) const {
  wait.attach(strokes_);
  wait.attach(resumes_);
}

void StrokeServer::take() {
  strokes_.take([&](const Stroke& stroke) { take(stroke); });
  // Last, so that the reply to a request contains all that was received before it.
  resumes_.take([&](const ResumeRequest& request) { take(request); });
}

void StrokeServer::take(const ResumeRequest& request) {
  if (!isSame(request.session, parts_.session)) return;
  const Id client = idOf(request.client);
  if (!followers_.contains(client)) {
    if (followers_.size() >= kMaxStrokeFollowers) {
      const auto last =
          std::ranges::max_element(followers_, {}, [](const auto& one) { return one.second.lastHeard.elapsed_s(); });
      if (last->second.lastHeard.elapsed_s() < kWriterTimeout_s) {
        ++counts_.refused;
        return;
      }
      followers_.erase(last);
    }
    followers_[client].results =
        Writer<Result>(parts_.participant, parts_.topics.results, reliableQos(false, partitionOf(request.client)));
    if (parts_.log) parts_.log->say("{} receives the edits", printable(request.host));
  }
  Follower& follower = followers_[client];
  follower.lastHeard = {};
  if (request.epoch <= follower.epoch) return;
  follower.epoch = request.epoch;
  follower.counter = 0;
  // A client that starts from the beginning gets its own strokes, too.
  follower.place = {.upTo = std::min<std::uint64_t>(request.upTo, parts_.points.head()),
                    .ownUpTo = request.upTo == 0 ? parts_.points.head() : 0};
  follower.holds = false;
  follower.toldAcked = ~std::uint64_t{0};  // it gets a result at once
}

void StrokeServer::heard(const Id& client) {
  if (const auto found = followers_.find(client); found != followers_.end()) found->second.lastHeard = {};
}

void StrokeServer::take(const Stroke& stroke) {
  if (!isSame(stroke.session, parts_.session)) return;
  const std::span<const State> given(stroke.states._buffer, stroke.states._length);
  states_.clear();
  for (const State& state : given) states_.push_back(pointOf(state));
  const Id client = idOf(stroke.client);
  heard(client);
  const SharedPoints::Taken taken = parts_.points.take(client, stroke.number, states_);
  counts_.sculptors = parts_.points.clients();
  switch (taken) {
    case SharedPoints::Taken::taken:
      ++counts_.pieces;
      counts_.states += states_.size();
      if (parts_.journal) parts_.journal->add({.client = client, .number = stroke.number, .states = states_});
      break;
    case SharedPoints::Taken::known:
    case SharedPoints::Taken::early:
      ++counts_.again;
      break;
    case SharedPoints::Taken::refused:
      if (counts_.refused++ == 0 && parts_.log)
        parts_.log->say(
            "a piece of a stroke was refused, and others may be: it is invalid, or {} hands have sculpted, which is "
            "the "
            "maximum",
            parts_.points.clients());
      break;
  }
}

double StrokeServer::write() {
  double next_s = kSilence_s;
  for (auto& [client, follower] : followers_) next_s = std::min(next_s, write(client, follower));
  return next_s;
}

double StrokeServer::write(const Id& client, Follower& follower) {
  const auto isDue = [&] {
    return follower.holds || parts_.points.isBehind(follower.place) ||
           parts_.points.lastOf(client) != follower.toldAcked;
  };
  const double since_s = follower.lastWritten.elapsed_s();
  if (!follower.holds && since_s < kApart_s) return isDue() ? kApart_s - since_s : kSilence_s;
  if (!isDue() && since_s < kSilence_s) return kSilence_s - since_s;
  int written = 0;
  do {
    if (!writeOne(client, follower)) return kApart_s;  // its link has no room for more
  } while (++written < kInTurn && parts_.points.isBehind(follower.place));
  follower.lastWritten = {};
  return parts_.points.isBehind(follower.place) ? 0 : kApart_s;
}

bool StrokeServer::writeOne(const Id& client, Follower& follower) {
  Result& result = follower.next;
  // `acked` is of the moment at which the states were collected: strokes of this client taken since come after them.
  if (!std::exchange(follower.holds, true)) {
    states_.clear();
    parts_.points.collect(follower.place, client, kStates, states_);
    follower.states.clear();
    for (const PointState& point : states_) follower.states.push_back(stateOf(point));
    result = {};
    set(result.session, parts_.session);
    result.epoch = follower.epoch;
    result.counter = ++follower.counter;
    result.acked = parts_.points.lastOf(client);
    result.upTo = follower.place.upTo;
    result.head = parts_.points.head();
    result.digest = parts_.points.digest();
    give(result.states, follower.states);
  }
  if (follower.unacked >= kMaxResults && follower.results.isAcked()) follower.unacked = 0;
  if (follower.unacked >= kMaxResults || !follower.results.write(result)) return false;
  ++follower.unacked;
  follower.holds = false;
  follower.toldAcked = result.acked;
  counts_.sent += follower.states.size();
  return true;
}

}  // namespace palpate::sharing
