// ctest: waits
// Copies of strokes and results: how many are sent, that numbers order them whichever path they take, and their benefit
// over lossy links.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <queue>
#include <set>

#include "haptics/sharing/copy_schedule.hpp"
#include "haptics/sharing/early_copies.hpp"
#include "haptics/sharing/edit_exchange.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/shared_points.hpp"
#include "tests/near.hpp"
#include "tests/sharing/honest_hand.hpp"

namespace palpate::copies_test {

using namespace sharing;

namespace {

constexpr double kPlenty = 1e9;

template <class Is>
bool within(double seconds, Is&& is) {
  const Stopwatch since;
  while (!is() && since.elapsed_s() < seconds) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  return is();
}

}  // namespace

TEST_CASE("an item is sent at once and three more times at intervals") {
  CopySchedule<int> schedule(kPlenty);
  std::vector<int> said;
  const auto at = [&](double now_s) {
    said.clear();
    schedule.sayDue(now_s, [&](int item) { said.push_back(item); });
    return said;
  };
  CHECK(at(0).empty());
  CHECK(schedule.next_s(0) > 1e9);
  schedule.add(1, 100, 1);
  schedule.add(2, 100, 1.004);
  CHECK(schedule.next_s(1) == 0);
  CHECK(at(1.004) == std::vector{1, 2});
  CHECK(at(1.005).empty());
  CHECK(schedule.next_s(1.005) == near(0.005, 1e-6));
  CHECK(at(1.011) == std::vector{1});
  CHECK(at(1.02) == std::vector{2});
  CHECK(at(1.04) == std::vector{1, 2});
  CHECK(at(1.069).empty());
  CHECK(at(1.08) == std::vector{1, 2});
  CHECK(at(2).empty());
  schedule.add(3, 100, 3);
  schedule.clear();
  CHECK(at(3.1).empty());
}

TEST_CASE("copies stay within their byte budget and nearly stop under heavy load") {
  const auto copiesOf = [](std::size_t bytes, double every_s) {
    CopySchedule<int> schedule(100e3);
    double said = 0;
    double next_s = 0;
    for (double now_s = 0; now_s < 10; now_s += 0.002) {
      if (now_s >= next_s) {
        schedule.add(1, bytes, now_s);
        next_s += every_s;
      }
      schedule.sayDue(now_s, [&](int) { said += static_cast<double>(bytes); });
    }
    return said;
  };
  // A tenth of the budget: four copies of everything.
  CHECK(copiesOf(100, 0.01) == near(4 * 100e3, 0.02));
  // Half of it: as much as the rest of the budget allows.
  const double some = copiesOf(500, 0.01);
  CHECK(some > 300e3);
  CHECK(some <= 100e3 * 10 + 20e3 - 500e3);
  // Ten times the budget.
  CHECK(copiesOf(2000, 0.002) < 30e3);
}

TEST_CASE("early copies wait for their predecessors, within a limited window") {
  EarlyCopies<int> early;
  early.keep(3, 0, 30);
  early.keep(2, 0, 20);
  early.keep(65, 0, 65);
  early.keep(~std::uint64_t{0}, 0, 1);
  early.keep(0, 0, 1);
  CHECK(early.size() == 2);
  CHECK_FALSE(early.takeAfter(0));
  CHECK(early.takeAfter(1) == 20);
  CHECK(early.takeAfter(2) == 30);
  CHECK_FALSE(early.takeAfter(3));
  // Numbers that were received on another path in the meantime are forgotten.
  for (std::uint64_t number = 5; number < 1000; ++number) early.keep(number, 3, 1);
  CHECK(early.size() == 63);
  CHECK_FALSE(early.takeAfter(100));
  CHECK(early.size() == 0);
}

TEST_CASE("a piece received only as a copy is applied once, after its predecessor, and counted as copied") {
  const PointCloud cloud = flatCloud(1000);
  Served served(cloud, "copied");
  HonestHand hand("copied");
  const JoinedCloud joined = joinCloud("copied", {.network = ownNetwork()});
  const JoinedSession& session = *joined.session;
  const Writer<Stroke> copies(session.participant, session.topics.strokeCopies, bestEffortQos());
  const Writer<Stroke> strokes(session.participant, session.topics.strokes, reliableQos(false));
  const auto isHeard = [&](const auto& writer) {
    return within(10, [&] {
      dds_publication_matched_status_t status{};
      return dds_get_publication_matched_status(writer, &status) == 0 && status.current_count > 0;
    });
  };
  REQUIRE(isHeard(copies));
  REQUIRE(isHeard(strokes));
  // It follows, so that early copies are kept.
  const Writer<ResumeRequest> resumes(session.participant, session.topics.resumes, reliableQos(false));
  std::uint8_t own[16];
  set(own, session.client);
  const Reader<Result> results(session.participant, session.topics.results, reliableQos(false, partitionOf(own)));
  std::uint32_t epoch = 0;
  REQUIRE(within(10, [&] {
    resumes.write(requestOf(session, {.epoch = ++epoch, .upTo = 0}));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    return results.take([](const Result&) {}) > 0;
  }));
  State state = stateOf(statesOf(cloud)[7]);
  state.position[2] = 5000;  // beyond the reach of the hand
  Stroke stroke{};
  set(stroke.session, session.session);
  set(stroke.client, session.client);
  stroke.states._buffer = &state;
  stroke.states._length = stroke.states._maximum = 1;
  const auto say = [&](const Writer<Stroke>& way, std::uint64_t number) {
    stroke.number = number;
    REQUIRE(way.write(stroke));
  };
  say(copies, 2);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  CHECK(hand.counts().received == 0);
  state.position[2] = 6000;
  for (int i = 0; i < 3; ++i) say(copies, 1);
  CHECK(within(10, [&] { return hand.counts().received >= 1; }));
  say(strokes, 1);  // already received as a copy
  say(strokes, 2);
  say(strokes, 2);  // sent twice on the reliable path, which no client of palpate does
  CHECK(hand.end().same);
  const ServedCounts counts = served.end();
  CHECK(counts.sculptors == 2);
  CHECK(counts.pieces >= 2);
  CHECK(counts.copied >= 2);
  CHECK(counts.again == 1);
  CHECK(counts.refused == 0);
}

TEST_CASE("a server's result is sent once reliably and as four copies, and early copies cause no resume request") {
  const PointCloud cloud = flatCloud(1000);
  Served served(cloud, "copied");
  const JoinedCloud joined = joinCloud("copied", {.network = ownNetwork()});
  const JoinedSession& session = *joined.session;
  std::uint8_t own[16];
  set(own, session.client);
  const Reader<Result> results(session.participant, session.topics.results, reliableQos(false, partitionOf(own)));
  const Reader<Result> copies(session.participant, session.topics.resultCopies,
                              keepingLast(bestEffortQos(partitionOf(own)), 4096));
  const Writer<ResumeRequest> resumes(session.participant, session.topics.resumes, reliableQos(false));
  HonestHand hand("copied");
  std::map<std::uint64_t, int> reliable, copied;
  std::uint32_t epoch = 0;
  // Until it has begun to follow, and then for a while.
  const auto hear = [&] {
    results.take([&](const Result& result) { ++reliable[result.counter]; });
    copies.take([&](const Result& result) { ++copied[result.counter]; });
  };
  CHECK(within(10, [&] {
    if (reliable.empty()) resumes.write(requestOf(session, {.epoch = ++epoch, .upTo = 0}));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    hear();
    return reliable.size() > 20;
  }));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  hear();
  int copiedWell = 0;
  for (const auto& [counter, times] : reliable) copiedWell += times == 1 && copied[counter] == 4;
  CAPTURE(reliable.size());
  CHECK(copiedWell > 15);

  // A result from far ahead, forged in the server's name, sent to the honest hand.
  const std::uint64_t resumed = hand.counts().resumed;
  std::optional<Id> victim;
  const Reader<sharing::HandSample> hands(session.participant, session.topics.hands, bestEffortQos());
  REQUIRE(within(10, [&] {
    hands.take([&](const sharing::HandSample& seen) { victim = idOf(seen.client); });
    return victim.has_value();
  }));
  set(own, *victim);
  const Writer<Result> forged(session.participant, session.topics.resultCopies, bestEffortQos(partitionOf(own)));
  Result result{};
  set(result.session, session.session);
  result.epoch = 1;
  result.counter = 1'000'000;
  for (int i = 0; i < 20; ++i) {
    forged.write(result);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  CHECK(hand.counts().resumed == resumed);
  const SharedCounts counts = hand.end();
  CHECK(counts.same);
  CHECK(counts.resumed == resumed);
}

namespace {

/// One direction of a link in virtual time: an ordered reliable stream, whose lost messages are sent again a round trip
/// later, and a best-effort stream. Frames of each are lost independently.
template <class Message>
class LossyWay {
 public:
  LossyWay(double trip_s, double loss, std::mt19937& dice) : trip_s_(trip_s), loss_(loss), dice_(dice) {}
  void sayReliably(const Message& message, double now_s) {
    double arrives_s = now_s + trip_s_ / 2;
    while (isLost()) arrives_s += trip_s_;
    inOrder_s_ = std::max(inOrder_s_, arrives_s);
    come_.push({inOrder_s_, number_++, message});
  }
  void sayOnce(const Message& message, double now_s) {
    if (!isLost()) come_.push({now_s + trip_s_ / 2, number_++, message});
  }
  template <class Take>
  void arrive(double now_s, Take&& take) {
    for (; !come_.empty() && come_.top().at_s <= now_s; come_.pop()) take(come_.top().message);
  }

 private:
  bool isLost() { return std::uniform_real_distribution<>(0, 1)(dice_) < loss_; }
  struct Come {
    double at_s;
    std::uint64_t number;
    Message message;
    bool operator<(const Come& other) const { return std::tie(at_s, number) > std::tie(other.at_s, other.number); }
  };
  double trip_s_, loss_, inOrder_s_ = 0;
  std::mt19937& dice_;
  std::priority_queue<Come> come_;
  std::uint64_t number_ = 0;
};

struct Told {
  Results results;
  std::vector<PointState> states;
};

/// Sorted delays, s, from one hand's change of a point until it is offered to another hand, equally far from the
/// server. One change each 10 ms for a second, then a second without changes.
std::vector<double> delaysOver(double trip_s, double loss, bool withCopies) {
  std::mt19937 dice(3);
  std::vector<PointState> points;
  for (std::uint32_t i = 0; i < 1000; ++i) points.push_back({.id = i, .normal = {0, 0, 1}, .parent = i});
  SharedPoints server(points);
  EditExchange maker(points, 16), follower(points, 16);
  maker.resume();
  const Resume asked = follower.resume();
  LossyWay<StrokePiece> strokes(trip_s, loss, dice);
  LossyWay<Told> results(trip_s, loss, dice);
  CopySchedule<StrokePiece> strokeCopies(kPlenty);
  CopySchedule<Told> resultCopies(kPlenty);
  SharedPoints::Place place;
  std::uint64_t counter = 0;
  std::map<std::uint32_t, double> made_s;
  std::vector<double> delays;
  std::uint32_t next = 0;
  EarlyCopies<StrokePiece> earlyStrokes;
  EarlyCopies<Told> earlyResults;
  std::uint64_t heard = 0;
  const auto hear = [&](const Told& told) {
    Results said = told.results;
    said.states = told.states;
    const EditExchange::Heard how = follower.hear(said);
    if (how == EditExchange::Heard::taken) heard = said.counter;
    return how;
  };
  const auto tell = [&](double now_s) {
    Told told;
    server.collect(place, Id{9}, 36, told.states);
    told.results = {.epoch = asked.epoch,
                    .counter = ++counter,
                    .upTo = place.upTo,
                    .head = server.head(),
                    .digest = server.digest(),
                    .states = {}};
    results.sayReliably(told, now_s);
    resultCopies.add(std::move(told), 100, now_s);
  };
  for (int ms = 0; next < 1000 || delays.size() < 1000; ms += 2) {
    REQUIRE(ms < 10'000'000);
    const double now_s = 1e-3 * ms;
    if (next < 1000 && ms % 10 == 0 && ms / 1000 % 2 == 0) {
      PointState state = points[next];
      state.position.x = 1;
      maker.follow({.points = {state}, .marks = {{1, EditMark::Kind::stroke}}});
      made_s[next++] = now_s;
    }
    while (const StrokePiece* piece = maker.outbox().nextPiece(36)) {
      strokes.sayReliably(*piece, now_s);
      strokeCopies.add(*piece, 100, now_s);
    }
    if (withCopies) {
      strokeCopies.sayDue(now_s, [&](const StrokePiece& piece) { strokes.sayOnce(piece, now_s); });
      resultCopies.sayDue(now_s, [&](const Told& told) { results.sayOnce(told, now_s); });
    }
    strokes.arrive(now_s, [&](const StrokePiece& piece) {
      const std::uint64_t last = server.lastOf(Id{1});
      if (server.take(Id{1}, piece.number, piece.states) == SharedPoints::Taken::early)
        earlyStrokes.keep(piece.number, last, piece);
      while (const auto early = earlyStrokes.takeAfter(server.lastOf(Id{1})))
        server.take(Id{1}, early->number, early->states);
    });
    if (server.isBehind(place)) tell(now_s);
    results.arrive(now_s, [&](const Told& told) {
      if (hear(told) == EditExchange::Heard::gap) earlyResults.keep(told.results.counter, heard, told);
      while (const auto early = earlyResults.takeAfter(heard)) hear(*early);
    });
    EditBatch batch;
    for (const PointChange& change : follower.nextOffer()) {
      delays.push_back(now_s - made_s.at(change.to.number()));
      batch.points.push_back(change.to);
    }
    if (batch.points.empty()) continue;
    batch.marks = {{batch.points.size(), EditMark::Kind::received}};
    follower.offered();
    follower.follow(batch);
  }
  CHECK(follower.digest() == server.digest());
  std::ranges::sort(delays);
  return delays;
}

}  // namespace

TEST_CASE("99 % of the changes over lossy links arrive within 40 ms of the trip time; without copies they do not") {
  for (const double trip_s : {0.1, 0.3, 1.0})
    for (const double loss : {0.01, 0.05}) {
      CAPTURE(trip_s);
      CAPTURE(loss);
      const auto with = delaysOver(trip_s, loss, true), without = delaysOver(trip_s, loss, false);
      CHECK(with.size() == 1000);
      CHECK(with[500] < trip_s + 0.008);
      CHECK(with[990] < trip_s + 0.040);
      CHECK(without[990] > 1.5 * trip_s);
    }
  const auto clean = delaysOver(0.1, 0, true);
  CHECK(clean.back() < 0.1 + 0.008);
}

}  // namespace palpate::copies_test
