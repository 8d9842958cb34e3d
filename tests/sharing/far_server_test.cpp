// ctest: waits
// Clients with only nearby points when their server dies, restarts, or is not palpate.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <optional>

#include "tests/error_of.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/sharing/honest_hand.hpp"
#include "tests/sharing/served_square.hpp"

namespace palpate::far_server_test {

using namespace sharing;

namespace {

/// A participant that forges the server's next sample for a client near its hand.
class Forger {
 public:
  Forger() : participant_(ownNetwork()), topics_(participant_), wants_(participant_, topics_.wants, bestEffortQos()) {}

  /// Sends an invalid sample for each expected one until `holds` is true.
  bool forge(double seconds, const std::function<bool()>& holds) {
    return within(seconds, [&] {
      wants_.take([&](const Want& want) {
        if (want.every == 0) heard_ = want;
      });
      if (heard_) write(*heard_);
      return holds();
    });
  }

 private:
  void write(const Want& near) {
    if (!bricks_) bricks_.emplace(participant_, topics_.points, reliableQos(false, partitionOf(idOf(near.client))));
    BrickPart part{.key = ~BrickKey{0}, .total = 1, .count = 0, .checksum = 0};
    Points sample{};
    std::memcpy(sample.session, near.session, sizeof sample.session);
    sample.epoch = near.epoch;
    sample.sample = near.taken + 1;
    give(sample.parts, std::span(&part, 1));
    bricks_->write(sample);
  }

  Participant participant_;
  Topics topics_;
  Reader<Want> wants_;
  std::optional<Want> heard_;  // without its balls, whose memory DDS owns
  std::optional<Writer<Points>> bricks_;
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

TEST_CASE("a silent server is reported; a client continues with a server of the same points and refuses other points") {
  const PointCloud cloud = square(), other = square(5);
  std::optional<Served> served(std::in_place, cloud, "again");
  const JoinedCloud joined = joinNear("again");
  BrickSource& source = joined.far->source();
  REQUIRE(comesTo(DVec3(30, 30, 0), source));
  served.reset();
  CHECK(within(30, [&] { return joined.far->known().share() == 0; }));
  // Known points are still there.
  CHECK(source.await(handAt(DVec3(30, 30, 0)), 0));
  CHECK_FALSE(source.await(handAt(DVec3(190, 190, 0)), 0));
  served.emplace(cloud, "again");
  CHECK(comesTo(DVec3(190, 190, 0), source));
  CHECK(within(30, [&] { return joined.far->known().share() == 1; }));
  CHECK(joined.far->counts().servers == 2);
  CHECK(joined.far->counts().longestSilent_s > 3);
  CHECK_NOTHROW(joined.far->check());
  served.reset();
  served.emplace(other, "again");
  CHECK(within(
      10, [&] { return errorOf([&] { joined.far->check(); }).find("has other points now") != std::string::npos; }));
  CHECK_FALSE(joined.far->known().isTrue());
}

TEST_CASE("a client with only nearby points continues after its server restarts with its journal") {
  const ScratchFolder folder;
  const PointCloud cloud = square();
  const CloudServer::Parts continued{.name = "journal", .journal = folder / "strokes"};
  std::optional<Served> served(std::in_place, cloud, continued);
  const JoinedCloud joined = joinNear("journal");
  BrickSource& source = joined.far->source();
  for (const double x : {20.0, 100.0, 180.0}) REQUIRE(comesTo(DVec3(x, 20, 0), source));
  CHECK(within(30, [&] { return joined.far->counts().samples > 256; }));  // more than the new server sends at once
  served.reset();
  served.emplace(cloud, continued);
  CHECK(comesTo(DVec3(100, 180, 0), source));
  CHECK(comesTo(DVec3(20, 180, 0), source));
  const FarCounts counts = joined.far->counts();
  CHECK(counts.servers == 1);
  CHECK(counts.resumed == 1);
  CHECK_NOTHROW(joined.far->check());
}

TEST_CASE("an invalid brick sample counts as missing, and ends the connection only if nothing else arrives") {
  const PointCloud cloud = square();
  std::optional<Served> served(std::in_place, cloud, "forged");
  const JoinedCloud joined = joinNear("forged");
  BrickSource& source = joined.far->source();
  REQUIRE(comesTo(DVec3(30, 30, 0), source));
  Forger forger;
  CHECK(forger.forge(30, [&] { return joined.far->counts().resumed >= 3; }));
  CHECK_NOTHROW(joined.far->check());
  CHECK(comesTo(DVec3(170, 170, 0), source));
  CHECK_NOTHROW(joined.far->check());
  CHECK(joined.far->known().isTrue());
  served.reset();
  CHECK(forger.forge(30, [&] { return !joined.far->known().isTrue(); }));
  CHECK_THROWS_WITH_AS(joined.far->check(), doctest::Contains("a brick has an invalid position"), NetworkError);
}

TEST_CASE("another hand's edits within reach of a client with only nearby points count as changes under its hand") {
  const PointCloud cloud = square();
  Served served(cloud, "changed");
  const JoinedCloud joined = joinNear("changed");
  BrickSource& source = joined.far->source();
  REQUIRE(comesTo(DVec3(50, 50, 0), source));
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
  std::optional<Served> served(std::in_place, cloud, "silent");
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

}  // namespace palpate::far_server_test
