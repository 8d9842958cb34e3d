// ctest: waits
// A cloud that is served and joined within this machine: its bits, its counts, and hostile or foreign participants.
#include "haptics/sharing/shared_cloud.hpp"

#include <doctest/doctest.h>

#include <array>
#include <string>
#include <thread>
#include <vector>

#include "engine/cloud/estimated_normals.hpp"
#include "engine/cloud/length_unit.hpp"
#include "engine/io/saving.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "haptics/sharing/messages.hpp"
#include "haptics/sharing/session_notices.hpp"
#include "haptics/sharing/wanted_points.hpp"
#include "tests/error_of.hpp"
#include "tests/says.hpp"
#include "tests/sharing/honest_hand.hpp"

namespace palpate::shared_cloud_test {

namespace {

PointCloud cloudOf(std::size_t points, bool colored = false, const DVec3& origin = DVec3(0)) {
  PointCloud cloud = ring(points);
  cloud.origin = origin;
  for (std::size_t i = 0; colored && i < points; ++i)
    cloud.colors.push_back({std::uint8_t(i), std::uint8_t(i >> 8), 3, std::uint8_t(255 - i % 7)});
  return cloud;
}

void checkSame(const PointCloud& is, const PointCloud& expected) {
  CHECK(is.origin == expected.origin);
  CHECK(is.positions == expected.positions);
  CHECK(is.normals == expected.normals);
  CHECK(is.colors == expected.colors);
}

}  // namespace

TEST_CASE("clouds of awkward sizes arrive bit for bit, with colours and far from zero") {
  for (const std::size_t points : {0u, 1u, 42u, 43u, 44u, 60'001u}) {
    CAPTURE(points);
    const PointCloud cloud = cloudOf(points, points % 2 == 1, points > 43 ? DVec3(4.5e6, -3e5, 1e3) : DVec3(0));
    Served served(cloud, "awkward");
    const JoinedCloud joined = joinCloud("awkward", {.network = ownNetwork()});
    checkSame(joined.cloud, cloud);
    CHECK(joined.mm_per_unit == 2.5);
    CHECK(joined.model == "a test's cloud");
  }
}

TEST_CASE("a client knows the unit and the grid of the file, and what of it stays with the server") {
  PointCloud cloud = cloudOf(100, false, DVec3(637000, 4877000, 0));
  const CoordinateGrid grid{.step = DVec3(0.01), .offset = DVec3(0.5)};
  cloud.storedAs.grid = grid;
  markNormalsAsEstimated(cloud, true);
  setUnit(cloud.storedAs.comments, LengthUnit::foot);
  for (const char* name : {"intensity", "gps_time"})
    cloud.extra.push_back({name, ScalarType::u8, std::vector<std::byte>(cloud.size())});
  {
    Served served(cloud, "scan");
    const JoinedCloud joined = joinCloud("scan", {.network = ownNetwork()});
    CHECK(unitSaidIn(joined.cloud.storedAs.comments) == LengthUnit::foot);
    CHECK(joined.cloud.storedAs.grid == grid);
    CHECK(areNormalsEstimated(joined.cloud));
    CHECK(joined.unsent == "intensity, gps_time");
  }
  for (int i = 0; i < 100; ++i)
    cloud.extra.push_back({fmt::format("attribute {}", i), ScalarType::u8, std::vector<std::byte>(cloud.size())});
  Served served(cloud, "long");
  const std::string unsent = joinCloud("long", {.network = ownNetwork()}).unsent;
  CHECK(says(unsent, "intensity, gps_time, attribute 0, attribute 1, "));
  CHECK(unsent.ends_with(" more"));
  CHECK(unsent.size() <= 200);
  CHECK(joinCloud("long", {.network = ownNetwork(), .partial = true}).far);
}

TEST_CASE("several clients join at once, and each receives the whole cloud") {
  const PointCloud cloud = cloudOf(40'000);
  Served served(cloud, "shared");
  std::vector<std::jthread> clients;
  std::array<JoinedCloud, 4> joined;
  for (JoinedCloud& one : joined)
    clients.emplace_back([&one] { one = joinCloud("shared", {.network = ownNetwork()}); });
  clients.clear();
  for (const JoinedCloud& one : joined) checkSame(one.cloud, cloud);
  const ServedCounts counts = served.end();
  CHECK(counts.clients == 4);
  CHECK(counts.refused == 0);
  CHECK(counts.blocks == 4 * 931);
}

TEST_CASE("a server sends what its client acknowledges, begins again on request, and ends a stream that is complete") {
  constexpr std::uint64_t kBlocks = 1000;
  const PointCloud cloud = cloudOf(sharing::kBlockPoints * kBlocks);
  Served served(cloud, "held");
  const sharing::Participant participant(ownNetwork());
  const sharing::Topics topics(participant);
  sharing::SessionNotices notices(participant, topics);
  REQUIRE(within(20, [&] { return !notices.listenFor("held", 0.1).empty(); }));
  sharing::WantedPoints stream(participant, topics, notices.known().front().session, sharing::freshId());
  std::uint64_t received = 0, blocks = 0;
  // Samples of the epoch until there are so many and no more come.
  const auto receives = [&](const sharing::Wanted& wanted, std::uint64_t expected) {
    const bool all = within(20, [&] {
      stream.ask(wanted);
      stream.take([&](const sharing::Points& sample) {
        if (sample.epoch != wanted.epoch) return;
        CHECK(sample.sample == received + 1);
        CHECK(sample.whole == (wanted.first + blocks + 1 == kBlocks));
        received = sample.sample;
        blocks += sample.points._length > 0;
      });
      return received >= expected;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stream.take([&](const sharing::Points&) { ++received; });
    return all && received == expected;
  };
  CHECK(receives({.epoch = 1}, 256));
  CHECK(receives({.epoch = 1, .taken = 256}, 256 + 512));  // each acknowledged sample widens the window
  received = blocks = 0;
  CHECK(receives({.epoch = 2, .first = 900}, 100));  // begins again from there
  CHECK(blocks == 100);
  stream.ask({.epoch = 2, .taken = 100, .first = 900});
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  received = blocks = 0;
  CHECK(receives({.epoch = 1, .first = 990}, 10));  // its stream has ended, so that it is a new client
  CHECK(served.end().clients == 2);
}

TEST_CASE("a session name is unique, and an unknown name is reported with the existing ones") {
  const PointCloud cloud = cloudOf(10);
  Served served(cloud, "city"), other(cloud, "another");
  CHECK(says(errorOf([&] { Served second(cloud, "city"); }), "give this one another name"));
  CHECK(says(errorOf([] { joinCloud("town", {.network = ownNetwork(), .timeout_s = 0.5}); }), "'city'"));
  CHECK(says(errorOf([&] { Served bad(cloud, ""); }), "is not a valid session name"));
  CHECK(says(errorOf([&] { Served bad(cloud, "a\nb"); }), "is not a valid session name"));
  CHECK(says(errorOf([&] { Served bad(cloud, std::string(201, 'x')); }), "is not a valid session name"));
}

TEST_CASE("a client that asks for the state is at rest only after the answer, and then has the strokes of others") {
  const PointCloud cloud = flatCloud(100);
  Served served(cloud, "slow to answer");
  struct Client {
    JoinedCloud joined = joinCloud("slow to answer", {.network = ownNetwork()});
    PlainEdits edits;
    std::unique_ptr<SharedFollower> follower =
        shareEdits({.session = joined.session, .cloud = joined.cloud, .edits = edits, .cell = 1});
    std::vector<PointState> points = statesOf(joined.cloud);

    void make(std::span<const PointState> states) {
      const EditBatch batch = edits.edit(states);
      for (const PointState& state : batch.points) points[state.number] = state;
      follower->catchUp(batch);
    }
    bool isSame() {
      make({});
      return follower->counts().same;
    }
  } watcher, sculptor;
  REQUIRE(within(20, [&] { return watcher.isSame() && sculptor.isSame(); }));
  served.pause();
  REQUIRE(watcher.isSame());  // according to the last result
  PointState moved = sculptor.points[7];
  moved.position.z = 3;
  sculptor.make({&moved, 1});
  REQUIRE(within(20, [&] { return sculptor.follower->counts().sent == 1; }));
  watcher.follower->askServer();
  CHECK_FALSE(within(0.3, [&] { return watcher.isSame(); }));
  CHECK_FALSE(watcher.follower->counts().idle);
  served.goOn();
  REQUIRE(within(20, [&] { return sculptor.isSame(); }));  // the server has the edit
  watcher.follower->askServer();
  REQUIRE(within(20, [&] { return watcher.isSame(); }));
  CHECK(watcher.points[7].position.z == 3);
  CHECK(watcher.follower->counts().resent == 0);
  CHECK(served.end().states == 1);
}

TEST_CASE("a piece of a stroke that is sent twice is applied once, and repeated and early ones are counted") {
  const PointCloud cloud = flatCloud(100);
  Served served(cloud, "repeated");
  const JoinedCloud joined = joinCloud("repeated", {.network = ownNetwork()});
  const JoinedSession& session = *joined.session;
  const sharing::Writer<sharing::Stroke> strokes(session.participant, session.topics.strokes,
                                                 sharing::reliableQos(false));
  REQUIRE(within(10, [&] {
    dds_publication_matched_status_t status{};
    return dds_get_publication_matched_status(strokes, &status) == 0 && status.current_count > 0;
  }));
  std::array state{sharing::stateOf(statesOf(cloud)[7])};
  sharing::Stroke stroke{};
  sharing::set(stroke.session, session.session);
  sharing::set(stroke.client, session.client);
  sharing::give(stroke.states, state);
  for (const std::uint32_t number : {1, 1, 3, 2}) {
    stroke.number = number;
    state[0].position[2] = static_cast<float>(number);
    REQUIRE(strokes.write(stroke));
  }
  ServedCounts counts;
  CHECK(within(10, [&] {
    counts = served.end();
    served.goOn();
    return counts.pieces == 2;
  }));
  CHECK(counts.again == 2);
  CHECK(counts.refused == 0);
  CHECK(counts.sculptors == 1);
  served.end();
  CHECK(served.points()[7].position.z == 2);
}

namespace {

/// Serves until it ends, and keeps the reason for its end.
class ServedToTheEnd {
 public:
  ServedToTheEnd(const PointCloud& cloud, const std::string& name)
      : thread_([this, &cloud, name](const std::stop_token& stop) {
          why_ = errorOf<NetworkError>([&] {
            CloudServer server(cloud, {.network = ownNetwork(), .name = name});
            isServing_ = true;
            while (!stop.stop_requested()) server.serve(false, 0.05);
          });
          hasEnded_ = true;
        }) {}
  bool hasEnded() const { return hasEnded_; }
  bool isServing() const { return isServing_; }
  std::string why() {
    thread_ = {};
    return why_;
  }

 private:
  std::atomic<bool> isServing_ = false, hasEnded_ = false;
  std::string why_;
  std::jthread thread_;  // destroyed first
};

}  // namespace

TEST_CASE("of two servers that take one name at the same time, one ends with a reason and the other continues") {
  const PointCloud cloud = flatCloud(100);
  {
    ServedToTheEnd first(cloud, "twins"), second(cloud, "twins");
    CHECK(within(20, [&] { return first.hasEnded() || second.hasEnded(); }));
    // The other one continues.
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    CHECK(first.hasEnded() != second.hasEnded());
    ServedToTheEnd& gone = first.hasEnded() ? first : second;
    CHECK(says(gone.why(), "give"));
    CHECK(joinCloud("twins", {.network = ownNetwork()}).cloud.positions == cloud.positions);
  }
  // A session that neither knew, announced by others as older or newer.
  const sharing::Participant participant(ownNetwork());
  const sharing::Topics topics(participant);
  sharing::Notice notice{};
  notice.version = sharing::kVersion;
  sharing::put(notice.name, "alike");
  sharing::put(notice.host, "elsewhere");
  notice.mm_per_unit = 1;
  {
    const dds_time_t before = dds_time();
    ServedToTheEnd late(cloud, "alike");
    REQUIRE(within(10, [&] { return late.isServing(); }));
    const HonestHand hand("alike");
    CHECK_FALSE(late.hasEnded());
    const sharing::Writer<sharing::Notice> writer(participant, topics.notices, sharing::reliableQos(true));
    sharing::set(notice.session, sharing::freshId());
    writer.writeAt(notice, before);
    CHECK(within(5, [&] { return late.hasEnded(); }));
    CHECK(says(late.why(), "before this one, which ends"));
    CHECK(says(late.why(), "elsewhere"));
    // A client of the ended session receives the reason.
    CHECK(within(10, [&] { return !hand.counts().fault.empty(); }));
    CHECK(says(hand.counts().fault, "was restarted without its edits"));
  }
  {
    ServedToTheEnd early(cloud, "alike");
    REQUIRE(within(10, [&] { return early.isServing(); }));
    const sharing::Writer<sharing::Notice> writer(participant, topics.notices, sharing::reliableQos(true));
    sharing::set(notice.session, sharing::freshId());
    writer.writeAt(notice, dds_time() + 1'000'000'000);
    std::this_thread::sleep_for(std::chrono::seconds(1));
    CHECK_FALSE(early.hasEnded());
    CHECK(early.why().empty());
  }
}

TEST_CASE("the sessions of a network are listed and answer pings") {
  const PointCloud cloud = cloudOf(1234);
  Served served(cloud, "listed");
  const auto seen = discoverSessions(ownNetwork(), 1).sessions;
  REQUIRE(seen.size() == 1);
  CHECK(seen[0].name == "listed");
  CHECK(seen[0].points == 1234);
  CHECK(seen[0].compatible);
  CHECK(seen[0].pings == 50);
  CHECK(seen[0].answered > 25);
  REQUIRE(seen[0].roundTrip_ms);
  CHECK(*seen[0].roundTrip_ms > 0);
}

TEST_CASE("invalid networks are refused by name") {
  CHECK(says(errorOf([] { discoverSessions({.interface = "nowhere0", .domain = 201}, 0.1); }), "nowhere0"));
  CHECK(says(errorOf([] { discoverSessions({.interface = "a\"/><x"}, 0.1); }), "neither the name of an interface"));
  CHECK(says(errorOf([] { discoverSessions({.peers = {"<x>"}}, 0.1); }), "neither the name of an interface"));
  CHECK(says(errorOf([] { discoverSessions({.domain = 1000}, 0.1); }), "is not between 0 and"));
  CHECK(says(opennessOf({}), "programs of this machine"));
  CHECK(says(opennessOf({.interface = "eth0"}), "nothing is encrypted"));
}

TEST_CASE("joining can be interrupted") {
  std::atomic<bool> stop = false;
  std::jthread later([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop = true;
  });
  CHECK(says(errorOf([&] {
               joinCloud("never", {.network = ownNetwork(), .timeout_s = 60, .stop = [&] { return stop.load(); }});
             }),
             "interrupted"));
}

TEST_CASE("one thread can join a network while another leaves it") {
  const std::atomic<bool> stop = true;
  std::array<std::vector<std::string>, 2> said;
  {
    std::vector<std::jthread> threads;
    for (std::vector<std::string>& mine : said)
      threads.emplace_back([&] {
        for (int turn = 0; turn < 200; ++turn)
          mine.push_back(
              errorOf([&] { joinCloud("nobody's", {.network = ownNetwork(), .stop = [&] { return stop.load(); }}); }));
      });
  }
  for (const std::vector<std::string>& mine : said) {
    CHECK(mine.size() == 200);
    for (const std::string& message : mine) CHECK(says(message, "interrupted"));
  }
}

}  // namespace palpate::shared_cloud_test
