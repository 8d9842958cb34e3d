// ctest: waits
// The points around hands over a network of this machine: still, moving, and pressed.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <mutex>
#include <set>

#include "haptics/sharing/messages.hpp"
#include "tests/labels.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sharing/honest_hand.hpp"
#include "tests/sharing/served_square.hpp"

namespace palpate::far_cloud_test {

using namespace sharing;

namespace {

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

}  // namespace

TEST_CASE("a client with only nearby points receives those around its moving hand and few others") {
  const PointCloud cloud = square();
  Served served(cloud, "near");
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
      REQUIRE(comesTo(hip, source));
      CHECK(around(source, hip, frame) == 25);  // of a square lattice within 2.96 of one of its points
    }
    CHECK(source.known().points < 30'000);
    CHECK(within(30, [&] { return joined.far->counts().roundTrip_ms.has_value(); }));
    CHECK(joined.far->known().share() == 1);
    CHECK(joined.far->counts().resumed == 0);
  }
  const ServedCounts counts = served.end();
  CHECK(counts.partial == 1);
  CHECK(counts.partialPoints > 100);
  CHECK(counts.refused == 0);
}

TEST_CASE("invalid requests for nearby points are counted and change nothing") {
  const PointCloud cloud = square();
  Served served(cloud, "hostile");
  const JoinedCloud joined = joinNear("hostile");
  {
    const Participant participant(ownNetwork());
    const Topics topics(participant);
    const Writer<Want> wants(participant, topics.wants, bestEffortQos());
    const Facts facts = announcedFacts(participant, topics);
    std::uint32_t number = 0;
    const auto send = [&](std::vector<palpate_sharing_Ball> balls) {
      Want near{};
      std::memcpy(near.session, facts.session, sizeof near.session);
      near.epoch = 1;
      near.number = ++number;
      near.taken = ~std::uint64_t{0};
      give(near.balls, balls);
      wants.write(near);
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
  CHECK(comesTo(DVec3(50, 50, 1), joined.far->source()));
  const ServedCounts counts = served.end();
  CHECK(counts.refused >= 4);
  CHECK(counts.refused <= 20);
}

TEST_CASE("moving points are sent repeatedly with their time, and the motion receives the pressing hand") {
  const PointCloud cloud = square();
  std::mutex lock;
  std::vector<SeenHand> seen;
  double serverBegan_s = std::numeric_limits<double>::infinity();  // on this machine's clock, also the server's
  const auto motion = [&](double time_s, std::span<const SeenHand> hands, CloudFrame& frame) {
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
  };
  Served served(cloud, {.name = "moving", .sculptable = false, .motion = motion});
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
  const auto stands = [](double, std::span<const SeenHand>, CloudFrame&) { return false; };
  const auto told = [&] {
    const std::scoped_lock hold(lock);
    return restarts;
  };
  Served served(cloud, {.name = "restarting", .sculptable = false, .motion = stands, .restarts = told});
  std::array<Lines, 2> lines;
  std::array<Log, 2> logs{Log(true), Log(true)};
  std::array<JoinedCloud, 2> joined;
  for (std::size_t i = 0; i < 2; ++i) {
    logs[i].listen(&lines[i]);
    joined[i] = joinNear("restarting", &logs[i]);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  for (std::size_t i = 0; i < 2; ++i) CHECK(lines[i].restarts().empty());  // it was so when they joined
  restarted(4, "has diverged\033[2J");
  const auto areTold = [&](std::size_t times) {
    return std::ranges::all_of(lines, [&](const Lines& each) { return each.restarts().size() == times; });
  };
  REQUIRE(within(30, [&] { return areTold(1); }));
  for (const Lines& each : lines) {
    CHECK(each.restarts()[0].find("'restarting'") != std::string::npos);
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
    const JoinedCloud latest = joinNear("restarting", &lateLog);
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
  CHECK(static_cast<double>(lines[0].restarts().size()) <= 3 + 2 * since.elapsed_s());
  CHECK(within(30, [&] { return lines[0].restarts().size() > 2; }));
  joined = {};
  served.end();
}

TEST_CASE("hands at impossible positions do not press a moving model") {
  const PointCloud cloud = square();
  std::mutex lock;
  std::set<std::string> seen;
  const auto motion = [&](double, std::span<const SeenHand> hands, CloudFrame&) {
    const std::scoped_lock hold(lock);
    for (const SeenHand& hand : hands) seen.insert(hand.name);
    return false;
  };
  Served served(cloud, {.name = "pressed", .sculptable = false, .motion = motion});
  const Participant participant(ownNetwork());
  const Topics topics(participant);
  const Writer<sharing::HandSample> hands(participant, topics.hands, bestEffortQos());
  const Facts facts = announcedFacts(participant, topics);
  std::uint32_t number = 0;
  const auto send = [&](const std::string& name, double x, double proxy) {
    sharing::HandSample hand{};
    std::memcpy(hand.session, facts.session, sizeof hand.session);
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

}  // namespace palpate::far_cloud_test
