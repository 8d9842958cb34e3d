// ctest: waits
// A session under attack: another process sends invalid messages as fast as it can. Meanwhile nothing ends, nothing
// grows without a bound, and honest participants continue.
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <malloc.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <string>
#include <thread>

#include "engine/core/clock.hpp"
#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/far_link.hpp"
#include "haptics/sharing/joined_session.hpp"
#include "tests/error_of.hpp"
#include "tests/labels.hpp"
#include "tests/says.hpp"
#include "tests/sharing/honest_hand.hpp"
#include "tests/sharing/served_square.hpp"

#if defined(__SANITIZE_ADDRESS__)
extern "C" std::size_t __sanitizer_get_current_allocated_bytes();  // not every compiler provides its header
#endif

namespace palpate::hostile_network_test {

namespace {

constexpr double kMB = 1e6;

/// Duration of an attack.
double attack_s() { return byTier(0.4, 1.5); }

/// Memory of this process that is allocated and not freed.
double allocated_MB() {
#if defined(__SANITIZE_ADDRESS__)
  return static_cast<double>(__sanitizer_get_current_allocated_bytes()) / kMB;
#else
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) / kMB;
#endif
}

class HostileSide {
 public:
  HostileSide(const std::string& attack, double seconds) {
    const std::string domain = std::to_string(ownNetwork().domain), time_s = std::to_string(seconds);
    child_ = ::fork();
    if (child_ == 0) {
      ::execl(PALPATE_HOSTILE_SIDE, PALPATE_HOSTILE_SIDE, domain.c_str(), attack.c_str(), time_s.c_str(), "1", nullptr);
      ::_exit(127);
    }
    REQUIRE(child_ > 0);
  }
  ~HostileSide() {
    if (child_ > 0) end(SIGKILL);
  }
  HostileSide(const HostileSide&) = delete;
  HostileSide& operator=(const HostileSide&) = delete;

  void signal(int number) const { ::kill(child_, number); }
  bool ended() {
    if (child_ > 0 && ::waitpid(child_, &status_, WNOHANG) == child_) child_ = 0;
    return child_ == 0;
  }
  int end(int number) {
    if (!ended()) {
      signal(number);
      ::waitpid(child_, &status_, 0);
      child_ = 0;
    }
    return status_;
  }

 private:
  pid_t child_ = 0;
  int status_ = 0;
};

/// Makes the attack, with `meanwhile` every 20 ms. Returns the longest time for which the machine itself stopped.
template <class Meanwhile>
double stoodDuring(const std::string& attack, double seconds, Meanwhile&& meanwhile) {
  HostileSide side(attack, seconds);
  double stood_s = 0, last_s = 0;
  for (const Stopwatch since; !side.ended() && since.elapsed_s() < seconds + 30;
       std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
    stood_s = std::max(stood_s, since.elapsed_s() - last_s);
    last_s = since.elapsed_s();
    meanwhile();
  }
  CHECK(side.end(SIGKILL) == 0);  // it has found the session and sent something
  return stood_s;
}

struct Outcome {
  double grown_MB = 0;  ///< maximum during the attack
  SharedCounts hand;
  ServedCounts served;
};

/// A session with an honest hand during an attack.
Outcome attacked(const std::string& attack, double seconds) {
  CAPTURE(attack);
  const PointCloud cloud = flatCloud(20'000);
  Served served(cloud, "attacked");
  HonestHand hand("attacked");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  Outcome outcome;
  const double before_MB = allocated_MB();
  const double stood_s = stoodDuring(attack, seconds, [&] {
    outcome.grown_MB = std::max(outcome.grown_MB, allocated_MB() - before_MB);
    for (const SeenHand& other : hand.others()) {
      CHECK(glm::length(other.place.position) < 1e12);  // every hand can be drawn
      CHECK(glm::length(other.place.proxy) < 1e12);
    }
  });
  outcome.hand = hand.end();
  // A later client gets all points.
  CHECK(joinCloud("attacked", {.network = ownNetwork()}).cloud.positions == cloud.positions);
  outcome.served = served.end();
  MESSAGE(
      fmt::format("{}: at most {:.1f} MB; longest silence {:.2f} s, round trip {:.1f} ms, {} sent, {} received; "
                  "{} blocks, {} refused, {} sculptors, {} pieces, {} duplicates, {} clients",
                  attack, outcome.grown_MB, outcome.hand.longestSilent_s, outcome.hand.link.roundTrip_ms.value_or(-1),
                  outcome.hand.sent, outcome.hand.received, outcome.served.blocks, outcome.served.refused,
                  outcome.served.sculptors, outcome.served.pieces, outcome.served.again, outcome.served.clients));
  CHECK(outcome.hand.delivered);
  CHECK(outcome.hand.same);
  CHECK(outcome.hand.sent > 50);
  CHECK(outcome.hand.longestSilent_s < 2.9 + stood_s);  // beyond this the force would fade
  CHECK(outcome.grown_MB < 60);
  return outcome;
}

}  // namespace

TEST_CASE("a flood of requests under ten thousand identities delays no other client" * kClock * kMoreInFull) {
  const Outcome requests = attacked("requests", attack_s());
  CHECK(requests.served.refused > 1000);
  CHECK(requests.served.clients < 100);
  const Outcome resumes = attacked("resumes", attack_s());
  CHECK(resumes.served.refused > 1000);
  attacked("one-resumes", attack_s());
}

TEST_CASE("floods of strokes, of hands beyond the limit and of invalid strokes are applied, counted or refused" *
          kMoreInFull) {
  CHECK(attacked("strokes", attack_s()).served.pieces > 1000);
  const Outcome sculptors = attacked("sculptors", attack_s());
  CHECK(sculptors.served.sculptors > 200);
  CHECK(sculptors.served.sculptors <= 4096);
  CHECK(attacked("bad-strokes", attack_s()).served.refused > 0);
}

TEST_CASE("floods of invalid hands, of sessions and of forged results do not fill a client's memory" * kMoreInFull) {
  for (const char* attack : {"hands", "notices", "results"}) CHECK(attacked(attack, attack_s()).grown_MB < 15);
}

namespace {

struct NearOutcome {
  FarCounts hand;
  ServedCounts served;
};

/// A wandering client near its hand during an attack.
NearOutcome attackedNear(const std::string& attack, double seconds) {
  CAPTURE(attack);
  const PointCloud cloud = flatCloud(20'000);
  Served served(cloud, "attacked");
  const JoinedCloud joined = joinNear("attacked");
  REQUIRE(comesTo({50, 20, 0}, joined.far->source()));
  const double stood_s = stoodDuring(attack, seconds, [] {});
  const FarCounts during = joined.far->counts();
  // Up to 64 others are served first, each for some milliseconds, ten times that with sanitizers.
  CHECK(comesTo({50, 180, 0}, joined.far->source()));
  CHECK_NOTHROW(joined.far->check());
  const NearOutcome outcome{.hand = during, .served = served.end()};
  MESSAGE(fmt::format("{}: longest silence {:.2f} s, round trip {:.1f} ms, {} times resumed; {} clients, {} refused",
                      attack, outcome.hand.longestSilent_s, outcome.hand.roundTrip_ms.value_or(-1),
                      outcome.hand.resumed, outcome.served.partial, outcome.served.refused));
  CHECK(outcome.hand.longestSilent_s < 1 + stood_s);
  return outcome;
}

}  // namespace

TEST_CASE("repeated requests for all points around eight hands delay no other client" * kClock) {
  attackedNear("one-near", 1);
}

TEST_CASE("ten thousand requesters of nearby points stay within the limit and displace no client" * kClock) {
  const NearOutcome many = attackedNear("nears", 1);
  CHECK(many.served.partial <= 64);
  CHECK(many.served.refused > 1000);
}

TEST_CASE("forged bricks do not end the connection of a client with only nearby points") {
  CHECK(attackedNear("bricks", 1).hand.resumed > 10);
}

TEST_CASE("facts of endlessly many sessions delay no client" * kClock) { attackedNear("facts", 1); }

TEST_CASE("facts of thousands of sessions do not hide the later facts of the joined session") {
  const JoinedSession session(ownNetwork(), sharing::freshId(), sharing::freshId());
  const sharing::Participant hostile(ownNetwork());
  const sharing::Topics topics(hostile);
  const sharing::Writer<sharing::Facts> writer(hostile, topics.facts, sharing::reliableQos(true));
  sharing::Facts facts{};
  facts.edge = facts.spacing = 1;
  const auto say = [&](const sharing::Id& of, std::uint64_t points) {
    sharing::set(facts.session, of);
    facts.points = points;
    writer.write(facts);
  };
  for (int i = 0; i < 3000; ++i) say(sharing::freshId(), 1);
  std::optional<FarFacts> heard;
  std::jthread hears([&] { heard = hearFacts(session, 20, {}); });
  std::this_thread::sleep_for(std::chrono::seconds(1));
  for (int i = 0; i < 3000; ++i) say(sharing::freshId(), 1);
  say(session.session, 1234);
  hears.join();
  REQUIRE(heard);
  CHECK(heard->extent.points == 1234);
}

TEST_CASE("facts with an unknown unit or an invalid grid are refused") {
  const sharing::Participant hostile(ownNetwork());
  const sharing::Topics topics(hostile);
  const sharing::Writer<sharing::Facts> writer(hostile, topics.facts, sharing::reliableQos(true));
  const auto heard = [&](auto&& change) {
    const JoinedSession session(ownNetwork(), sharing::freshId(), sharing::freshId());
    sharing::Facts facts{};
    facts.edge = facts.spacing = 1;
    facts.gridded = true;
    for (double& step : facts.step) step = 0.01;
    change(facts);
    sharing::set(facts.session, session.session);
    writer.write(facts);
    return errorOf([&] { hearFacts(session, 20, {}); });
  };
  CHECK(heard([](sharing::Facts&) {}).empty());
  CHECK(says(heard([](sharing::Facts& facts) { facts.unit = 6; }), "announces an invalid cloud"));
  CHECK(says(heard([](sharing::Facts& facts) { facts.step[1] = 0; }), "announces an invalid cloud"));
  CHECK(says(heard([](sharing::Facts& facts) { facts.offset[2] = std::nan(""); }), "announces an invalid cloud"));
}

TEST_CASE("foreign pings and random bytes disturb no client" * kMoreInFull) {
  attacked("pings", attack_s());
  attacked("bytes", attack_s() + 0.2);
}

TEST_CASE("suspended readers with undelivered data delay no other client" * kClock * kMoreInFull) {
  const PointCloud cloud = flatCloud(20'000);
  Served served(cloud, "attacked");
  HonestHand hand("attacked");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const double before_MB = allocated_MB();
  double grown_MB = 0;
  HostileSide side("unread", 30);
  for (const Stopwatch since; since.elapsed_s() < byTier(3.0, 5.0);
       std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
    if (since.elapsed_s() > 1.5) side.signal(SIGSTOP);
    grown_MB = std::max(grown_MB, allocated_MB() - before_MB);
  }
  const SharedCounts counts = hand.end();
  CHECK(side.end(SIGKILL) != 0);
  const ServedCounts handed = served.end();
  MESSAGE(fmt::format(
      "suspended reader: at most {:.0f} MB, longest silence {:.2f} s, round trip {:.1f} ms, {} blocks to {} clients",
      grown_MB, counts.longestSilent_s, counts.link.roundTrip_ms.value_or(-1), handed.blocks, handed.clients));
  CHECK(counts.same);
  CHECK(counts.longestSilent_s < 2);
  CHECK(grown_MB < 400);
  CHECK(handed.clients > 40);
}

}  // namespace palpate::hostile_network_test
