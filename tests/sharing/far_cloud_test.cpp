// ctest: waits
// The points around hands over a network of this machine: still, sculpted by others, moving; and a server that dies or
// is not palpate's.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <functional>
#include <future>
#include <mutex>
#include <optional>
#include <set>

#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/messages.hpp"
#include "tests/labels.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sharing/honest_hand.hpp"

namespace palpate::far_cloud_test {

using namespace sharing;

namespace {

/// A square of 200 x 200 points, one apart.
PointCloud square(float height = 0) {
  PointCloud cloud;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) {
      cloud.positions.emplace_back(x, y, height);
      cloud.normals.emplace_back(0, 0, 1);
    }
  return cloud;
}

class ServedSquare {
 public:
  explicit ServedSquare(const PointCloud& cloud, const std::string& name, ServedMotion motion = {},
                        const std::filesystem::path& journal = {}, std::function<Restarts()> restarts = {})
      : server_(cloud, {.network = ownNetwork(),
                        .name = name,
                        .sculptable = !motion,
                        .journal = journal,
                        .motion = std::move(motion),
                        .restarts = std::move(restarts)}),
        thread_([this] { server_.serve(stop_); }) {}
  ~ServedSquare() { end(); }
  ServedCounts end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    return server_.counts();
  }
  /// Valid after end().
  std::span<const PointState> points() const { return server_.points(); }

 private:
  std::atomic<bool> stop_ = false;
  CloudServer server_;
  std::jthread thread_;
};

bool within(double seconds, const std::function<bool()>& holds) {
  for (const double end_s = steadyNow_s() + seconds; steadyNow_s() < end_s;) {
    if (holds()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return holds();
}

HandReaches handAt(const DVec3& hip) {
  HandReaches hands{.time_s = steadyNow_s(), .steady_s = steadyNow_s(), .count = 1};
  hands.hands[0] = {.low = hip - 3.0, .high = hip + 3.0, .hip = hip, .proxy = hip};
  return hands;
}

/// Number of points of the newest frame within 3 of the hand.
std::size_t around(BrickSource& source, const DVec3& hip, CloudFrame& frame) {
  source.makeFrame(steadyNow_s(), frame);
  std::size_t found = 0;
  for (const Vec3& position : frame.positions) found += glm::distance(DVec3(position), hip) < 3;
  return found;
}

/// The logged lines, and those about restarts.
class Lines final : public LogListener {
 public:
  void said(std::string_view line) override {
    const std::scoped_lock hold(lock_);
    if (line.find("has restarted") != std::string_view::npos) restarts_.emplace_back(line);
  }
  void progressed(std::string_view, double) override {}
  std::vector<std::string> restarts() const {
    const std::scoped_lock hold(lock_);
    return restarts_;
  }

 private:
  mutable std::mutex lock_;
  std::vector<std::string> restarts_;
};

JoinedCloud joinNear(const std::string& name, Log* log = nullptr) {
  return joinCloud(name, {.network = ownNetwork(), .near = true, .log = log});
}

}  // namespace

TEST_CASE("a client with only nearby points receives those around its moving hand and few others") {
  const PointCloud cloud = square();
  ServedSquare served(cloud, "near");
  {
    const JoinedCloud joined = joinNear("near");
    REQUIRE(joined.far);
    REQUIRE(joined.facts);
    CHECK(joined.facts->extent.points == 40'000);
    CHECK(joined.facts->extent.bounds == boundsOf(cloud));
    CHECK_FALSE(joined.facts->moves);
    CHECK(joined.cloud.size() == 8000);  // every fifth point
    CHECK(joined.cloud.positions[1] == cloud.positions[5]);
    BrickSource& source = joined.far->source();
    CloudFrame frame;
    for (const DVec3& hip : {DVec3(20, 20, 0.5), DVec3(60, 20, 0.5), DVec3(150, 160, 0.5)}) {
      const HandReaches hands = handAt(hip);
      source.ask(hands);
      REQUIRE(source.await(hands, 30));
      CHECK(around(source, hip, frame) == 25);  // of a square lattice within 2.96 of one of its points
    }
    CHECK(source.known().points < 30'000);
    CHECK(within(30, [&] { return joined.far->counts().roundTrip_ms.has_value(); }));
    CHECK(joined.far->known().share() == 1);
    CHECK(joined.far->counts().resumed == 0);
  }
  const ServedCounts counts = served.end();
  CHECK(counts.near == 1);
  CHECK(counts.nearPoints > 100);
  CHECK(counts.refused == 0);
}

TEST_CASE("invalid requests for nearby points are counted and change nothing") {
  const PointCloud cloud = square();
  ServedSquare served(cloud, "hostile");
  const JoinedCloud joined = joinNear("hostile");
  {
    const Participant participant(ownNetwork());
    const Topics topics(participant);
    const Writer<Near> nears(participant, topics.nears, bestEffortQos());
    const Reader<Facts> facts(participant, topics.facts, reliableQos(true));
    std::optional<Facts> heard;
    REQUIRE(within(30, [&] {
      facts.take([&](const Facts& one) { heard = one; });
      return heard.has_value();
    }));
    std::uint32_t number = 0;
    const auto send = [&](std::vector<palpate_sharing_Ball> balls) {
      Near near{};
      std::memcpy(near.session, heard->session, sizeof near.session);
      near.epoch = 1;
      near.number = ++number;
      near.taken = ~std::uint64_t{0};
      near.balls._buffer = balls.data();
      near.balls._length = near.balls._maximum = static_cast<std::uint32_t>(balls.size());
      nears.write(near);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (int again = 0; again < 5; ++again) {
      send({{.center = {nan, 0, 0}, .radius = 1}});
      send({{.center = {0, 0, 0}, .radius = nan}});
      send({{.center = {0, 0, 0}, .radius = -1}});
      send({{.center = {1e300, 0, 0}, .radius = 1}});
      send({{.center = {0, 0, 1e29}, .radius = 1e29}});  // far too much empty space
    }
  }
  const HandReaches hands = handAt(DVec3(50, 50, 1));
  joined.far->source().ask(hands);
  CHECK(joined.far->source().await(hands, 30));
  const ServedCounts counts = served.end();
  CHECK(counts.refused >= 4);
  CHECK(counts.refused <= 20);
}

TEST_CASE("moving points are sent repeatedly with their time, and the motion receives the pressing hand") {
  const PointCloud cloud = square();
  std::mutex lock;
  std::vector<SeenHand> seen;
  double serverBegan_s = std::numeric_limits<double>::infinity();  // on this machine's clock, also the server's
  ServedSquare served(cloud, "moving", [&](double time_s, std::span<const SeenHand> hands, CloudFrame& frame) {
    const double called_s = steadyNow_s();
    frame.time_s = time_s;
    frame.positions = cloud.positions;
    for (Vec3& position : frame.positions) position.z = static_cast<float>(time_s);
    frame.normals = cloud.normals;
    frame.velocities.assign(cloud.size(), Vec3(0, 0, 1));
    const std::scoped_lock hold(lock);
    serverBegan_s = std::min(serverBegan_s, called_s - time_s);
    seen.assign(hands.begin(), hands.end());
    return true;
  });
  const JoinedCloud joined = joinCloud("moving", {.network = ownNetwork()});
  const auto presence = sharePresence(joined.session, "a test's", joined.cloud);
  REQUIRE(joined.far);  // without a request for it
  CHECK(joined.facts->moves);
  CHECK_FALSE(joined.sculptable);
  BrickSource& source = joined.far->source();
  CloudFrame frame;
  double last = 0, before_s = 0, fastest_s = std::numeric_limits<double>::infinity();
  std::size_t frames = 0, torn = 0, placed = 0, early = 0, late = 0;
  const DVec3 hip(100, 100, 0);
  const double begin_s = steadyNow_s();
  while (steadyNow_s() < begin_s + (frames > 60 ? 2 : 20)) {
    HandReaches hands = handAt(hip + DVec3(0, 0, last));
    hands.time_s -= begin_s;
    source.ask(hands);
    HandPlaces shown{.count = 3};
    for (int i = 0; i < 3; ++i) shown.hands[i].position = shown.hands[i].proxy = hip + DVec3(10 * i, 0, last);
    presence->moved(shown);
    std::this_thread::sleep_for(std::chrono::milliseconds(4));
    if (!source.hasNewer(0, 0)) continue;
    source.makeFrame(steadyNow_s() - begin_s, frame);
    if (frame.positions.empty()) continue;
    for (const Vec3& position : frame.positions) torn += position.z != frame.positions[0].z;
    CHECK(frame.velocities.front() == Vec3(0, 0, 1));
    const double height = frame.positions[0].z;
    ++frames;
    CHECK(height >= last);
    last = height;
    // The height is the server's time: a frame's time is when its points were there, plus the shortest latency so far.
    fastest_s = std::min(fastest_s, steadyNow_s() - height);
    const double there_s = frame.time_s + begin_s - height;
    const double began_s = [&] {
      const std::scoped_lock hold(lock);
      return serverBegan_s;
    }();
    constexpr double kRounding_s = 1e-5;
    // A frame that would not be later than the previous one gets the next possible time.
    const bool isNext = frame.time_s < before_s + 1e-9;
    before_s = frame.time_s;
    placed += !isNext;
    early += there_s < began_s - kRounding_s;
    late += !isNext && there_s > fastest_s + kRounding_s;
  }
  CHECK(torn == 0);
  CHECK(frames > 60);
  CHECK(frames < 70 * (steadyNow_s() - begin_s));
  CHECK(placed > frames / 2);
  CHECK(early == 0);
  CHECK(late == 0);
  CHECK(joined.far->counts().mostKnown <= 1 << 13);
  {
    const std::scoped_lock hold(lock);
    // All hands of the client.
    REQUIRE(seen.size() == 3);
    const std::array<const char*, 3> names{"a test's", "a test's, hand 2", "a test's, hand 3"};
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(seen[i].name == names[i]);
      CHECK(glm::distance(seen[i].place.position, hip + DVec3(10.0 * double(i), 0, last)) < 5);
    }
  }
  CHECK(served.end().frames > 60);
}

TEST_CASE("a restart of the motion is reported once to each client, and not to clients that join later") {
  const PointCloud cloud = square();
  std::mutex lock;
  Restarts restarts{.count = 3, .why = "was before"};
  const auto restarted = [&](std::uint32_t count, const std::string& why) {
    const std::scoped_lock hold(lock);
    restarts = {.count = count, .why = why};
  };
  ServedSquare served(
      cloud, "begins anew", [](double, std::span<const SeenHand>, CloudFrame&) { return false; }, {},
      [&] {
        const std::scoped_lock hold(lock);
        return restarts;
      });
  std::array<Lines, 2> lines;
  std::array<Log, 2> logs{Log(true), Log(true)};
  std::array<JoinedCloud, 2> joined;
  for (std::size_t i = 0; i < 2; ++i) {
    logs[i].listen(&lines[i]);
    joined[i] = joinNear("begins anew", &logs[i]);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  for (std::size_t i = 0; i < 2; ++i) CHECK(lines[i].restarts().empty());  // it was so when they joined
  restarted(4, "has diverged\033[2J");
  const auto areTold = [&](std::size_t times) {
    return std::ranges::all_of(lines, [&](const Lines& each) { return each.restarts().size() == times; });
  };
  REQUIRE(within(30, [&] { return areTold(1); }));
  for (const Lines& each : lines) {
    CHECK(each.restarts()[0].find("'begins anew'") != std::string::npos);
    CHECK(each.restarts()[0].find("it has diverged?[2J") != std::string::npos);
  }
  restarted(6, "has burst");
  REQUIRE(within(30, [&] { return areTold(2); }));
  for (const Lines& each : lines) CHECK(each.restarts()[1].find("2 times: it has burst") != std::string::npos);
  for (const JoinedCloud& each : joined) CHECK(each.far->counts().restarts == 3);
  Lines late;
  Log lateLog(true);
  lateLog.listen(&late);
  {
    const JoinedCloud latest = joinNear("begins anew", &lateLog);
    std::this_thread::sleep_for(std::chrono::milliseconds(1000));
    CHECK(latest.far->counts().restarts == 0);
  }
  CHECK(late.restarts().empty());
  CHECK(areTold(2));  // not again
  // A server that reports a thousand restarts a second is not forwarded at that rate.
  const Stopwatch since;
  for (std::uint32_t count = 7; since.elapsed_s() < 2; ++count) {
    restarted(count, "is in a hurry");
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const auto told = static_cast<double>(lines[0].restarts().size());
  CHECK(told <= 3 + 2 * since.elapsed_s());
  CHECK(within(30, [&] { return lines[0].restarts().size() > 2; }));
  joined = {};
  served.end();
}

TEST_CASE("hands at impossible positions do not press a moving model") {
  const PointCloud cloud = square();
  std::mutex lock;
  std::set<std::string> seen;
  ServedSquare served(cloud, "pressed", [&](double, std::span<const SeenHand> hands, CloudFrame&) {
    const std::scoped_lock hold(lock);
    for (const SeenHand& hand : hands) seen.insert(hand.name);
    return false;
  });
  const Participant participant(ownNetwork());
  const Topics topics(participant);
  const Writer<sharing::HandSample> hands(participant, topics.hands, bestEffortQos());
  const Reader<Facts> facts(participant, topics.facts, reliableQos(true));
  std::optional<Facts> heard;
  REQUIRE(within(30, [&] {
    facts.take([&](const Facts& one) { heard = one; });
    return heard.has_value();
  }));
  std::uint32_t number = 0;
  const auto send = [&](const std::string& name, double x, double proxy) {
    sharing::HandSample hand{};
    std::memcpy(hand.session, heard->session, sizeof hand.session);
    put(hand.name, name);
    hand.client[0] = name.back();
    hand.position[0] = x;
    hand.proxy[1] = proxy;
    hand.number = ++number;
    hands.write(hand);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(within(30, [&] {
    send("far a", 1e30, 0);
    send("far b", 0, 1e10);
    send("far c", nan, 0);
    send("near", 1e4, 100);
    const std::scoped_lock hold(lock);
    return seen.contains("near");
  }));
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  const std::scoped_lock hold(lock);
  CHECK(seen == std::set<std::string>{"near"});
}

TEST_CASE("a failing motion ends its server with the motion's message") {
  const PointCloud cloud = square();
  CloudServer server(
      cloud, {.network = ownNetwork(),
              .name = "fails",
              .sculptable = false,
              .motion = [](double, std::span<const SeenHand>, CloudFrame&) -> bool { throw Error("it has burst"); }});
  const std::atomic<bool> stop = false;
  CHECK_THROWS_WITH(server.serve(stop, 30), doctest::Contains("it has burst"));
}

TEST_CASE("a silent server is reported; a client continues with a server of the same points and refuses other points") {
  const PointCloud cloud = square(), other = square(5);
  std::optional<ServedSquare> served(std::in_place, cloud, "again");
  const JoinedCloud joined = joinNear("again");
  BrickSource& source = joined.far->source();
  source.ask(handAt(DVec3(30, 30, 0)));
  REQUIRE(source.await(handAt(DVec3(30, 30, 0)), 30));
  served.reset();
  CHECK(within(30, [&] { return joined.far->known().share() == 0; }));
  // Known points are still there.
  CHECK(source.await(handAt(DVec3(30, 30, 0)), 0));
  CHECK_FALSE(source.await(handAt(DVec3(190, 190, 0)), 0));
  served.emplace(cloud, "again");
  source.ask(handAt(DVec3(190, 190, 0)));
  CHECK(source.await(handAt(DVec3(190, 190, 0)), 30));
  CHECK(within(30, [&] { return joined.far->known().share() == 1; }));
  CHECK(joined.far->counts().servers == 2);
  CHECK(joined.far->counts().longestSilent_s > 3);
  CHECK_NOTHROW(joined.far->check());
  served.reset();
  served.emplace(other, "again");
  CHECK(within(10, [&] {
    try {
      joined.far->check();
      return false;
    } catch (const NetworkError& error) {
      return std::string(error.what()).find("has other points now") != std::string::npos;
    }
  }));
  CHECK_FALSE(joined.far->known().isTrue());
}

TEST_CASE("a client with only nearby points continues after its server restarts with its journal") {
  const ScratchFolder folder;
  const PointCloud cloud = square();
  std::optional<ServedSquare> served(std::in_place, cloud, "journal", ServedMotion{}, folder / "strokes");
  const JoinedCloud joined = joinNear("journal");
  BrickSource& source = joined.far->source();
  const auto comesTo = [&](const DVec3& hip) {
    source.ask(handAt(hip));
    return source.await(handAt(hip), 30);
  };
  for (const double x : {20.0, 100.0, 180.0}) REQUIRE(comesTo(DVec3(x, 20, 0)));
  CHECK(within(30, [&] { return joined.far->counts().samples > 256; }));  // more than the new server sends at once
  served.reset();
  served.emplace(cloud, "journal", ServedMotion{}, folder / "strokes");
  CHECK(comesTo(DVec3(100, 180, 0)));
  CHECK(comesTo(DVec3(20, 180, 0)));
  const FarCounts counts = joined.far->counts();
  CHECK(counts.servers == 1);
  CHECK(counts.resumed == 1);
  CHECK_NOTHROW(joined.far->check());
}

namespace {

/// A participant that forges the server's next sample for a client near its hand.
class Forger {
 public:
  Forger() : participant_(ownNetwork()), topics_(participant_), nears_(participant_, topics_.nears, bestEffortQos()) {}

  /// Sends an invalid sample for each expected one until `holds` is true.
  bool forge(double seconds, const std::function<bool()>& holds) {
    return within(seconds, [&] {
      nears_.take([&](const Near& near) { heard_ = near; });
      if (heard_) write(*heard_);
      return holds();
    });
  }

 private:
  void write(const Near& near) {
    if (!bricks_) bricks_.emplace(participant_, topics_.bricks, reliableQos(false, partitionOf(near.client)));
    BrickPart part{.key = ~BrickKey{0}, .total = 1, .count = 0};
    Bricks sample{};
    std::memcpy(sample.session, near.session, sizeof sample.session);
    sample.epoch = near.epoch;
    sample.sample = near.taken + 1;
    sample.parts._buffer = &part;
    sample.parts._length = sample.parts._maximum = 1;
    bricks_->write(sample);
  }

  Participant participant_;
  Topics topics_;
  Reader<Near> nears_;
  std::optional<Near> heard_;  // without its balls, whose memory DDS owns
  std::optional<Writer<Bricks>> bricks_;
};

/// At each message, queries the connection's state on another thread and waits for the answer.
class AskingListener final : public LogListener {
 public:
  void said(std::string_view) override {
    const FarCloud* const far = far_;
    if (!far) return;
    ++asked_;
    std::promise<void> answer;
    std::future<void> answered = answer.get_future();
    asking_.emplace_back([far, answer = std::move(answer)]() mutable {
      far->counts();
      answer.set_value();
    });
    answered_ += answered.wait_for(std::chrono::seconds(30)) == std::future_status::ready;
  }
  void progressed(std::string_view, double) override {}
  void about(const FarCloud* far) { far_ = far; }
  void wait() { asking_.clear(); }  // no more messages follow
  int asked() const { return asked_; }
  int answered() const { return answered_; }

 private:
  std::atomic<const FarCloud*> far_ = nullptr;
  std::atomic<int> asked_ = 0, answered_ = 0;
  std::vector<std::jthread> asking_;  // each ends after its message
};

}  // namespace

TEST_CASE("an invalid brick sample counts as missing, and ends the connection only if nothing else arrives") {
  const PointCloud cloud = square();
  std::optional<ServedSquare> served(std::in_place, cloud, "forged");
  const JoinedCloud joined = joinNear("forged");
  BrickSource& source = joined.far->source();
  source.ask(handAt(DVec3(30, 30, 0)));
  REQUIRE(source.await(handAt(DVec3(30, 30, 0)), 30));
  Forger forger;
  CHECK(forger.forge(30, [&] { return joined.far->counts().resumed >= 3; }));
  CHECK_NOTHROW(joined.far->check());
  source.ask(handAt(DVec3(170, 170, 0)));
  CHECK(source.await(handAt(DVec3(170, 170, 0)), 30));
  CHECK_NOTHROW(joined.far->check());
  CHECK(joined.far->known().isTrue());
  served.reset();
  CHECK(forger.forge(30, [&] { return !joined.far->known().isTrue(); }));
  CHECK_THROWS_WITH_AS(joined.far->check(), doctest::Contains("a brick has an invalid position"), NetworkError);
}

TEST_CASE("another hand's edits within reach of a client with only nearby points count as changes under its hand") {
  const PointCloud cloud = square();
  ServedSquare served(cloud, "changed");
  const JoinedCloud joined = joinNear("changed");
  BrickSource& source = joined.far->source();
  source.ask(handAt(DVec3(50, 50, 0)));
  REQUIRE(source.await(handAt(DVec3(50, 50, 0)), 30));
  CHECK_FALSE(within(0.5, [&] { return joined.far->known().isChanging(); }));
  HonestHand other("changed");
  CHECK(within(30, [&] { return joined.far->known().isChanging(); }));
  other.end();
}

TEST_CASE("a log listener can query the connection while it receives the message of a silent server") {
  const PointCloud cloud = square();
  AskingListener listener;
  Log log(true);
  log.listen(&listener);
  std::optional<ServedSquare> served(std::in_place, cloud, "silent");
  {
    const JoinedCloud joined = joinNear("silent", &log);
    REQUIRE(within(30, [&] { return joined.far->counts().answered > 0; }));
    listener.about(joined.far.get());
    served.reset();
    CHECK(within(30, [&] { return listener.answered() > 0; }));
    listener.about(nullptr);
    listener.wait();
  }
  CHECK(listener.asked() == listener.answered());
}

namespace {

constexpr double kRoom = 12;  // of the area where hands meet, along both sides

/// A hand near its points that edits those around it.
class NearSculptor {
 public:
  explicit NearSculptor(const std::string& name, unsigned seed) : joined_(joinNear(name)), random_(seed) {
    REQUIRE(joined_.far);
    REQUIRE(joined_.far->isSculptable());
  }
  FarCloud& far() const { return *joined_.far; }
  BrickSource& source() const { return joined_.far->source(); }

  bool comesTo(const DVec3& hip) {
    hip_ = hip;
    const HandReaches hands = handAt(hip);
    source().ask(hands);
    return source().await(hands, 30);
  }
  /// Points within the room.
  std::vector<PointState> points() const {
    std::vector<PointState> points;
    source().pointsIn(hip_ - kRoom / 2, hip_ + kRoom / 2, points);
    std::ranges::sort(points, {}, [](const PointState& point) { return point.id; });
    return points;
  }
  /// Some points are moved, a few removed, in one edit.
  void edit() {
    std::vector<PointChange> changes;
    std::uniform_real_distribution<float> by(-0.4f, 0.4f);
    for (const PointState& from : points()) {
      if (random_() % 5 != 0) continue;
      PointState to = from;
      for (int axis = 0; axis < 3; ++axis) to.position[axis] += by(random_);
      to.color = static_cast<std::uint32_t>(random_());
      if (random_() % 40 == 0) to.id |= PointState::kGone;
      changes.push_back({.from = from, .to = to});
    }
    source().make(changes);
  }

 private:
  JoinedCloud joined_;
  std::mt19937 random_;
  DVec3 hip_{0};
};

bool isSamePoint(const PointState& a, const PointState& b) {
  return a.number() == b.number() && a.gone() == b.gone() && a.position == b.position && a.normal == b.normal &&
         a.color == b.color;
}

}  // namespace

TEST_CASE("edits of several clients with only nearby points reach the server and each other once") {
  const PointCloud cloud = square();
  ServedSquare served(cloud, "sculpted near");
  std::vector<std::vector<PointState>> seen;
  std::uint64_t sent = 0;
  {
    NearSculptor first("sculpted near", 1), second("sculpted near", 2);
    const NearSculptor* const all[] = {&first, &second};
    const DVec3 place(100, 100, 0);
    REQUIRE(first.comesTo(place));
    REQUIRE(second.comesTo(place));
    for (int turn = 0; turn < 40; ++turn) {
      first.edit();
      if (turn % 2 == 0) second.edit();
      std::this_thread::sleep_for(std::chrono::milliseconds(7));
    }
    // Away and back: the edit made far away is unchanged.
    REQUIRE(first.comesTo(DVec3(20, 20, 0)));
    first.edit();
    REQUIRE(first.comesTo(place));
    for (const NearSculptor* hand : all) {
      CHECK(within(30, [&] { return hand->far().counts().delivered; }));
      sent += hand->far().counts().sent;
      CHECK(hand->far().counts().resent == 0);
    }
    CHECK(within(30, [&] {
      first.comesTo(place);
      second.comesTo(place);
      return first.source().known().own + second.source().known().own == 0 &&
             std::ranges::equal(first.points(), second.points(), isSamePoint);
    }));
    for (const NearSculptor* hand : all) seen.push_back(hand->points());
    CHECK_NOTHROW(first.far().check());
  }
  const ServedCounts counts = served.end();
  CHECK(counts.sculptors == 2);
  CHECK(counts.states == sent);
  CHECK(counts.again == 0);
  CHECK(counts.refused == 0);
  // The server's points equal those that the hands have seen, and all others are unchanged.
  const std::vector<PointState> before = statesOf(cloud);
  std::size_t changed = 0, wrong = 0;
  std::map<std::uint32_t, PointState> there;
  for (const PointState& point : seen[0]) there[point.number()] = point;
  for (const PointState& point : served.points()) {
    const PointState& old = before[point.number()];
    const bool isFar = glm::distance(DVec3(old.position), DVec3(100, 100, 0)) > 20 &&
                       glm::distance(DVec3(old.position), DVec3(20, 20, 0)) > 20;
    changed += !isSamePoint(point, old);
    if (isFar) wrong += !isSamePoint(point, old);
    const auto here = there.find(point.number());
    if (here != there.end()) wrong += !isSamePoint(point, here->second);
    const DVec3 off = glm::abs(DVec3(point.position) - DVec3(100, 100, 0));
    if (here == there.end() && !point.gone()) wrong += glm::max(glm::max(off.x, off.y), off.z) < kRoom / 2;
  }
  CHECK(changed > 100);
  CHECK(wrong == 0);
}

TEST_CASE("continuous edits of the same nearby points are acknowledged without a resend" * kClock) {
  const PointCloud cloud = square();
  ServedSquare served(cloud, "on and on");
  NearSculptor hand("on and on", 4);
  REQUIRE(hand.comesTo(DVec3(100, 100, 0)));
  // Each point is edited again before the server has acknowledged it.
  const std::vector<PointState> points = hand.points();
  std::vector<PointState> now = points;
  for (const Stopwatch since; since.elapsed_s() < 7; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
    std::vector<PointChange> changes;
    for (PointState& point : now) {
      PointState next = point;
      next.position.z += 1e-4f;
      changes.push_back({.from = point, .to = next});
      point = next;
    }
    hand.source().make(changes);
  }
  CHECK(within(30, [&] { return hand.far().counts().delivered; }));
  CHECK(hand.far().counts().resent == 0);
  CHECK_NOTHROW(hand.far().check());
}

TEST_CASE("edits of nearby points during a server outage are applied once, after it restarts with its journal") {
  const PointCloud cloud = square();
  const ScratchFolder folder;
  std::optional<ServedSquare> served(std::in_place, cloud, "away", ServedMotion{}, folder / "strokes");
  NearSculptor hand("away", 3);
  const DVec3 place(100, 100, 0);
  REQUIRE(hand.comesTo(place));
  hand.edit();
  CHECK(within(30, [&] { return hand.far().counts().delivered; }));
  served.reset();
  for (int i = 0; i < 5; ++i) hand.edit();
  CHECK_FALSE(within(0.2, [&] { return hand.far().counts().delivered; }));
  const std::vector<PointState> made = hand.points();
  served.emplace(cloud, "away", ServedMotion{}, folder / "strokes");
  CHECK(within(20, [&] {
    hand.comesTo(place);
    return hand.far().counts().delivered;
  }));
  CHECK(within(30, [&] { return hand.source().known().own == 0; }));
  CHECK(std::ranges::equal(hand.points(), made, isSamePoint));
  CHECK_NOTHROW(hand.far().check());
  const std::uint64_t sent = hand.far().counts().sent;
  served->end();
  std::size_t wrong = 0;
  for (const PointState& point : made) wrong += !isSamePoint(served->points()[point.number()], point);
  CHECK(wrong == 0);
  CHECK(served->end().states == sent);
  // A server that restarts without the journal cannot accept this hand's edits.
  served.reset();
  served.emplace(cloud, "away", ServedMotion{});
  CHECK(within(20, [&] {
    try {
      hand.far().check();
      return false;
    } catch (const NetworkError& error) {
      return std::string(error.what()).find("was restarted without its edits") != std::string::npos;
    }
  }));
  CHECK_FALSE(hand.far().known().isTrue());
}

}  // namespace palpate::far_cloud_test
