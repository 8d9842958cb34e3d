// ctest: waits
// Hands ask their server to write its file.
#include <doctest/doctest.h>

#include <condition_variable>
#include <fstream>
#include <mutex>

#include "engine/io/cloud_formats.hpp"
#include "engine/io/saving.hpp"
#include "haptics/sharing/link_statistics.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sharing/undoing_hands.hpp"

namespace palpate::server_save_test {

using namespace sharing;

namespace {

const DVec3 kHere(100, 100, 0);
const std::vector<std::uint32_t> kRow{100 * 200 + 98, 100 * 200 + 99, 100 * 200 + 100};

std::optional<ServerSave> answerOf(ServerFile& file, double seconds = 30) {
  file.requestWrite();
  std::optional<ServerSave> answer;
  within(seconds, [&] {
    answer = file.answer();
    return answer.has_value();
  });
  return answer;
}

/// A save that takes until it is let go.
class SlowSave {
 public:
  std::string operator()(const PointCloud&) {
    std::unique_lock hold(lock_);
    most_ = std::max(most_, ++running_);
    ++writes_;
    changed_.wait_for(hold, std::chrono::seconds(60), [&] { return isFree_; });
    --running_;
    return "slow.ply";
  }
  void letGo() {
    const std::scoped_lock hold(lock_);
    isFree_ = true;
    changed_.notify_all();
  }
  int writes() const {
    const std::scoped_lock hold(lock_);
    return writes_;
  }
  int most() const {
    const std::scoped_lock hold(lock_);
    return most_;
  }

 private:
  mutable std::mutex lock_;
  std::condition_variable changed_;
  bool isFree_ = false;
  int running_ = 0, most_ = 0, writes_ = 0;
};

Ping echoOf(std::uint32_t number, std::uint64_t begun, std::uint64_t ended) {
  Ping echo{};
  echo.number = number;
  echo.writes = true;
  echo.begun = begun;
  echo.ended = ended;
  echo.points = 10 * ended;
  put(echo.words, "there.ply");
  return echo;
}

}  // namespace

TEST_CASE("a hand of either kind has the server write all points, with its own edits, to the server's file") {
  const PointCloud cloud = square();
  const ScratchFolder folder;
  const std::string file = (folder / "served.ply").string();
  std::ofstream(file) << "not a cloud";
  Served served(cloud, CloudServer::Parts{.name = "saved", .save = saverTo(file)});
  FarHand near("saved");
  WholeHand whole("saved");
  REQUIRE(near.comesTo(kHere));
  near.stroke(kRow, 1);
  REQUIRE(within(30, [&] { return near.isDelivered(); }));
  CHECK(answerOf(*near.far().file()) == ServerSave{.written = true, .points = cloud.size(), .words = file});
  PointCloud written = readCloud(file).cloud;
  REQUIRE(written.size() == cloud.size());
  for (const std::uint32_t point : kRow) CHECK(written.positions[point].z == 1);
  // The file that was there is kept, and of the server's own versions only the newest.
  whole.stroke(kRow, 2);
  REQUIRE(within(30, [&] { return whole.isDelivered(); }));
  const Stopwatch since;
  CHECK(answerOf(whole.file()) == ServerSave{.written = true, .points = cloud.size(), .words = file});
  CHECK(since.elapsed_s() > 1);  // once in five seconds at most
  written = readCloud(file).cloud;
  const float height = served.end().states == 6 ? written.positions[kRow[0]].z : -1;
  CHECK((height == 2 || height == 3));  // whether or not it had the other's stroke
  for (const PointState& point : served.points()) CHECK(written.positions[point.number] == point.position);
  std::string kept;
  std::getline(std::ifstream(file + ".bak"), kept);
  CHECK(kept == "not a cloud");
  CHECK_FALSE(std::filesystem::exists(file + ".bak3"));
}

TEST_CASE("a server without a file refuses, and one that cannot write it says why and continues") {
  const PointCloud cloud = square();
  {
    Served served(cloud, "refuses");
    FarHand hand("refuses");
    CHECK(answerOf(*hand.far().file()) == ServerSave{.words = "it was started without --save"});
  }
  bool isFull = true;
  Served served(cloud, CloudServer::Parts{.name = "full", .save = [&](const PointCloud&) -> std::string {
                                            if (isFull) throw Error("served.ply: the disk is full");
                                            return "served.ply";
                                          }});
  FarHand hand("full");
  REQUIRE(hand.comesTo(kHere));
  CHECK(answerOf(*hand.far().file()) == ServerSave{.words = "served.ply: the disk is full"});
  hand.stroke(kRow, 1);
  CHECK(within(30, [&] { return hand.isDelivered(); }));
  isFull = false;
  CHECK(answerOf(*hand.far().file()) == ServerSave{.written = true, .points = cloud.size(), .words = "served.ply"});
}

TEST_CASE("a flood of requests has one write at a time, and strokes of others are taken during it") {
  const PointCloud cloud = square();
  SlowSave slow;
  Served served(cloud, CloudServer::Parts{.name = "flood", .save = std::ref(slow)});
  FarHand asking("flood"), other("flood");
  REQUIRE(other.comesTo(kHere));
  // A hostile client, which asks for any write in each of a thousand pings.
  const Participant participant(ownNetwork());
  const Topics topics(participant);
  const Writer<Ping> pings(participant, topics.pings, bestEffortQos());
  asking.far().file()->requestWrite();
  REQUIRE(within(30, [&] { return slow.writes() == 1; }));
  Ping ping{};
  {
    const Reader<Notice> notices(participant, topics.notices, reliableQos(true));
    REQUIRE(within(30, [&] {
      bool isKnown = false;
      notices.take([&](const Notice& notice) {
        std::memcpy(ping.session, notice.session, sizeof ping.session);
        isKnown = true;
      });
      return isKnown;
    }));
  }
  for (int i = 0; i < 1000; ++i) {
    ping.client[0] = static_cast<std::uint8_t>(i);
    ping.write = ~std::uint64_t{0} - static_cast<std::uint64_t>(i % 3);
    pings.write(ping);
    if (i % 50 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  double longest_s = 0;
  for (int i = 0; i < 20; ++i) {
    const Stopwatch since;
    other.stroke(kRow, 1);
    REQUIRE(within(30, [&] { return other.isDelivered(); }));
    longest_s = std::max(longest_s, since.elapsed_s());
  }
  CHECK(longest_s < 1);
  CHECK(slow.writes() == 1);
  CHECK_FALSE(asking.far().file()->answer());
  const Stopwatch since;
  slow.letGo();
  CHECK(within(30, [&] { return slow.writes() == 2; }));  // for the flood
  CHECK(asking.far().file()->answer()->written);
  CHECK_FALSE(within(2, [&] { return slow.writes() > 2; }));
  CHECK(slow.most() == 1);
}

TEST_CASE("a request is answered by a write that begins after it, in whatever order echoes come") {
  WriteRequest request;
  request.answered(echoOf(1, 0, 0));
  CHECK(request.write() == 0);
  request.begin(7);
  CHECK(request.write() == 0);
  request.answered(echoOf(7, 3, 3));  // of a ping before the request
  CHECK(request.write() == 0);
  request.answered(echoOf(9, 4, 3));  // a write in progress may lack the last strokes
  CHECK(request.write() == 5);
  request.answered(echoOf(10, 4, 4));
  CHECK_FALSE(request.answer());
  request.answered(echoOf(8, 3, 3));  // late
  CHECK(request.write() == 4);
  request.answered(echoOf(11, 4, 4));
  CHECK(request.answer() == ServerSave{.written = true, .points = 40, .words = "there.ply"});
  CHECK(request.write() == 0);
  request.begin(11);
  CHECK_FALSE(request.answer());
  request.answered(echoOf(12, 9, 9));
  CHECK(request.write() == 10);
  request.answered(echoOf(13, 0, 0));  // another server has taken over
  CHECK(request.write() == 1);
  Ping failed = echoOf(14, 1, 1);
  failed.failed = true;
  put(failed.words, "full");
  request.answered(failed);
  CHECK(request.answer() == ServerSave{.words = "full"});
}

}  // namespace palpate::server_save_test
