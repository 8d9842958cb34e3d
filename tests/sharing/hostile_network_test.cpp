// A session amid others that mean it no good: another process says as fast as it can what no palpate says, and meanwhile
// nothing ends, nothing grows without a bound, and whoever is honest goes on.
#include <doctest/doctest.h>
#include <malloc.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <string>
#include <thread>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"
#include "haptics/sharing/shared_edits.hpp"
#include "tests/sharing/own_network.hpp"

#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/allocator_interface.h>
#endif

namespace palpate {

namespace {

constexpr double kMB = 1e6;

/// What this process has of memory that it has asked for and not given back.
double allocated_MB() {
#if defined(__SANITIZE_ADDRESS__)
  return static_cast<double>(__sanitizer_get_current_allocated_bytes()) / kMB;
#else
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd) / kMB;
#endif
}

PointCloud cloudOf(std::size_t points) {
  PointCloud cloud;
  for (std::size_t i = 0; i < points; ++i) {
    cloud.positions.emplace_back(static_cast<float>(i % 100), static_cast<float>(i / 100), 0);
    cloud.normals.emplace_back(0, 0, 1);
  }
  return cloud;
}

/// Takes at once what others have done, and does what it is told to.
class PlainBackend final : public TouchBackend {
 public:
  std::span<const Contact> ask(std::span<const Pose>, double) noexcept override { return {}; }
  void finish() override {}
  std::size_t readBack(PointCloud&) const override { return 0; }
  bool offer(std::span<const PointChange> changes, std::uint64_t) override {
    const std::scoped_lock hold(lock_);
    for (const PointChange& change : changes) batch_.points.push_back(change.to);
    batch_.marks.push_back({batch_.points.size(), EditMark::Kind::received});
    return true;
  }
  std::size_t mostOffered() const override { return 256; }
  std::string machine() const override { return "a test's"; }
  double buildTime_us() const override { return 0; }
  const std::vector<double>& editTimes_us() const override { return times_; }
  std::optional<double> firstEditTime_s() const override { return std::nullopt; }
  const TouchShortfalls& shortfalls() const override { return shortfalls_; }
  IndexWork indexWork() const override { return {}; }
  double cell() const override { return 1; }

  /// All that was done since the last time, and at its end these.
  EditBatch edit(std::span<const PointState> states) {
    const std::scoped_lock hold(lock_);
    batch_.points.insert(batch_.points.end(), states.begin(), states.end());
    if (!states.empty()) batch_.marks.push_back({batch_.points.size(), EditMark::Kind::stroke});
    return std::exchange(batch_, {});
  }

 private:
  std::mutex lock_;
  EditBatch batch_;
  std::vector<double> times_;
  TouchShortfalls shortfalls_;
};

/// A hand that is honest: moves a point each few milliseconds, and shows where it is.
class HonestHand {
 public:
  explicit HonestHand(const std::string& name)
      : joined_(joinCloud(name, {.network = ownNetwork()})),
        follower_(shareEdits({.session = joined_.session, .cloud = joined_.cloud, .backend = backend_, .hand = "honest"})),
        thread_([this](const std::stop_token& stop) { run(stop); }) {}

  /// Moves no more, and waits until all is where it belongs.
  SharedCounts end() {
    sculpts_ = false;
    for (const Stopwatch since; since.elapsed_s() < 10 && !follower_->counts().same;)
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    thread_.request_stop();
    thread_.join();
    CHECK(fault_ == "");
    return follower_->counts();
  }
  SharedCounts counts() const { return follower_->counts(); }
  std::vector<SeenHand> others() const { return follower_->others(); }

 private:
  void run(const std::stop_token& stop) {
    std::mt19937 dice(7);
    const std::vector<PointState> states = statesOf(joined_.cloud);
    try {
      while (!stop.stop_requested()) {
        PointState state = states[dice() % states.size()];
        state.position.z = static_cast<float>(dice() % 1000);
        follower_->catchUp(backend_.edit(sculpts_ ? std::span(&state, 1) : std::span<PointState>()));
        follower_->moved({.position = DVec3(1), .proxy = DVec3(1), .touching = true, .sculpts = true});
        std::this_thread::sleep_for(std::chrono::milliseconds(4));
      }
    } catch (const NetworkError& error) {
      fault_ = error.what();
    }
  }

  JoinedCloud joined_;
  PlainBackend backend_;
  std::unique_ptr<SharedFollower> follower_;
  std::string fault_;
  std::atomic<bool> sculpts_ = true;
  std::jthread thread_;  // goes first
};

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

struct Outcome {
  double grown_MB = 0;  ///< at most, while it went on
  SharedCounts hand;
  ServedCounts served;
};

/// A session with an honest hand while somebody attacks it for so long.
Outcome attacked(const std::string& attack, double seconds) {
  CAPTURE(attack);
  const PointCloud cloud = cloudOf(20'000);
  Served served(cloud, "attacked");
  HonestHand hand("attacked");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  Outcome outcome;
  const double before_MB = allocated_MB();
  HostileSide side(attack, seconds);
  for (const Stopwatch since; !side.ended() && since.elapsed_s() < seconds + 12; std::this_thread::sleep_for(std::chrono::milliseconds(20)))
    outcome.grown_MB = std::max(outcome.grown_MB, allocated_MB() - before_MB);
  CHECK(side.end(SIGKILL) == 0);  // it has found the session and has said something
  outcome.hand = hand.end();
  // Whoever comes later has what there is.
  CHECK(joinCloud("attacked", {.network = ownNetwork()}).cloud.positions == cloud.positions);
  outcome.served = served.end();
  MESSAGE(fmt::format("{}: {:.1f} MB at most; longest silence {:.2f} s, round trip {:.1f} ms, {} sent, {} received; {} requests, "
                      "{} blocks, {} refused, {} sculptors, {} pieces, {} again, {} clients",
                      attack, outcome.grown_MB, outcome.hand.longestSilent_s, outcome.hand.roundTrip_ms.value_or(-1), outcome.hand.sent,
                      outcome.hand.received, outcome.served.requests, outcome.served.blocks, outcome.served.refused,
                      outcome.served.sculptors, outcome.served.pieces, outcome.served.again, outcome.served.clients));
  CHECK(outcome.hand.delivered);
  CHECK(outcome.hand.same);
  CHECK(outcome.hand.sent > 50);
  CHECK(outcome.hand.longestSilent_s < 2.9);  // beyond which the force would fade
  CHECK(outcome.grown_MB < 120);
  return outcome;
}

}  // namespace

TEST_CASE("who asks for everything again and again, in the name of ten thousand, keeps nobody else waiting") {
  const Outcome requests = attacked("requests", 1.5);
  CHECK(requests.served.refused > 1000);
  CHECK(requests.served.clients < 100);
  const Outcome resumes = attacked("resumes", 1.5);
  CHECK(resumes.served.refused > 1000);
  attacked("one-resumes", 1.5);
}

TEST_CASE("strokes without end, of more hands than there can be, and such as no hand makes, are taken, counted or refused") {
  CHECK(attacked("strokes", 1.5).served.pieces > 1000);
  const Outcome sculptors = attacked("sculptors", 1.5);
  CHECK(sculptors.served.sculptors == 4096);
  CHECK(sculptors.served.refused > 0);
  CHECK(attacked("bad-strokes", 1.5).served.refused > 0);
}

TEST_CASE("hands that are nowhere, sessions by the thousand and answers that no server gives do not fill a client's memory") {
  attacked("hands", 1.5);
  attacked("notices", 1.5);
  attacked("results", 1.5);
}

TEST_CASE("bytes that are no samples of ours are no more than noise") {
  attacked("pings", 1.5);
  attacked("bytes", 2);
}

TEST_CASE("readers that have fallen asleep with all that there is on the way to them hold up nobody") {
  const PointCloud cloud = cloudOf(20'000);
  Served served(cloud, "attacked");
  HonestHand hand("attacked");
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  const double before_MB = allocated_MB();
  double grown_MB = 0;
  HostileSide side("unread", 30);
  for (const Stopwatch since; since.elapsed_s() < 5; std::this_thread::sleep_for(std::chrono::milliseconds(20))) {
    if (since.elapsed_s() > 1.5) side.signal(SIGSTOP);
    grown_MB = std::max(grown_MB, allocated_MB() - before_MB);
  }
  const SharedCounts counts = hand.end();
  CHECK(side.end(SIGKILL) != 0);
  const ServedCounts handed = served.end();
  MESSAGE(fmt::format("asleep: {:.0f} MB at most, longest silence {:.2f} s, round trip {:.1f} ms, {} blocks to {} clients", grown_MB,
                      counts.longestSilent_s, counts.roundTrip_ms.value_or(-1), handed.blocks, handed.clients));
  CHECK(counts.same);
  CHECK(counts.longestSilent_s < 2);
  CHECK(grown_MB < 400);
  CHECK(handed.clients > 40);
}

}  // namespace palpate
