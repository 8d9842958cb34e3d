// Time until one hand's edit of a shared cloud is felt by another: one hand presses where the other rests. Both belong
// to this program, so that one clock times both; the server may be anywhere, and every edit goes through it.
#include <atomic>
#include <limits>
#include <random>
#include <thread>

#include "apps/bench/bench.hpp"
#include "apps/cli/sharing_options.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "engine/cloud/analytic_shape.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/latest_value.hpp"
#include "haptics/devices/haptic_device.hpp"
#include "haptics/sharing/shared_cloud.hpp"

namespace palpate {

namespace {

// A hand that a bench moves, which records the time of arrival and the time of a force change.

constexpr double kChange_N = 0.001;  // far below the smallest force that a hand can feel, far above the changes at rest

/// Positions are in model units. The bench commands it on one thread; ticks run on another. Times are from `clock`.
class ToldHand final : public HapticDevice {
 public:
  /// `clock` must outlive it. It starts at `place`.
  ToldHand(const Stopwatch& clock, const DVec3& place) : clock_(clock) { goTo(place, true); }

  // For the bench.
  /// Takes effect at the next tick. `isPutDown`: a jump without motion in between.
  void goTo(const DVec3& place, bool isPutDown) {
    target_.store({.place = place, .number = ++told_, .isPutDown = isPutDown});
  }

  /// When it first reached the last commanded position; empty before that.
  std::optional<double> arrived_s() const {
    const std::optional<Arrival> arrival = arrival_.load();
    if (!arrival || arrival->number != told_) return std::nullopt;
    return arrival->time_s;
  }

  struct Felt {
    DVec3 force_N{0};
    double since_s = 0;  ///< time of the last change, within the watch's threshold
    double now_s = 0;
  };
  Felt felt() const { return felt_.load().value_or(Felt{}); }
  /// Records the first change of the force from now on.
  void watch() {
    changed_s_ = -1;
    isWatching_ = true;
  }

  /// Time of that change; empty before it.
  std::optional<double> changed_s() const {
    const double changed_s = changed_s_;
    return changed_s < 0 ? std::nullopt : std::optional(changed_s);
  }

  std::string_view name() const override { return "told"; }
  DeviceLimits limits() const override {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    return {.peakForce_N = kNone, .continuousForce_N = kNone, .fastest_mm_per_s = kNone, .handHeld = false};
  }

  DeviceState read(double) noexcept override {
    DeviceState state{.ok = true};
    if (const auto target = target_.load(); target && target->number != now_.number) {
      now_ = *target;
      state.putDown = now_.isPutDown;
      arrival_.store({.number = now_.number, .time_s = clock_.elapsed_s()});
    }
    state.position = now_.place;
    return state;
  }

  bool write(const DVec3& force_N) noexcept override {
    last_.now_s = clock_.elapsed_s();
    if (glm::distance(force_N, last_.force_N) > kChange_N) {
      last_.force_N = force_N;
      last_.since_s = last_.now_s;
      if (isWatching_.exchange(false)) changed_s_ = last_.now_s;
    }
    felt_.store(last_);
    return true;
  }

  void emergencyStop() noexcept override {}  // no force to switch off
  std::string faultText() const override { return {}; }

 private:
  struct Target {
    DVec3 place{0};
    std::uint64_t number = 0;
    bool isPutDown = false;
  };
  struct Arrival {
    std::uint64_t number = 0;
    double time_s = 0;
  };
  const Stopwatch& clock_;
  std::uint64_t told_ = 0;
  LatestValue<Target> target_;
  LatestValue<Arrival> arrival_;
  LatestValue<Felt> felt_;
  std::atomic<bool> isWatching_ = false;
  std::atomic<double> changed_s_ = -1;
  // Used only by the ticks' thread.
  Target now_;
  Felt last_;
};

struct ShareOptions {
  std::string name;  // empty: this program serves a sphere
  NetworkOptions network;
  std::int64_t points = 20'000;
};

constexpr double kRest_mm = 1, kPress_mm = 3;  // below the surface
constexpr double kSteady_s = 0.06;             // without a change, before the press
constexpr double kGoal_ms = 20;                // beyond the round trip

/// A hand of this program, on its own thread, until its time is over.
class SharedHand {
 public:
  SharedHand(Context& context, SessionConfig config, const std::string& name, const Stopwatch& clock)
      : config_(std::move(config)),
        session_(config_, loadModel(config_.model, {.log = context.log(), .join = joiningHand(name)}),
                 {.backend = context.backends().named(config_.backend.name), .threads = 1, .log = &context.log()}),
        device_(clock, farPlace()) {
    if (!session_.shared())
      throw Error("'{}' is served read-only (--read-only): it cannot be pressed", config_.model.file);
    thread_ = std::jthread([this] {
      try {
        const OpenHand hand{.device = &device_};
        result_ = session_.run({&hand, 1}, {.stop = &stop_});
      } catch (const std::exception& error) {
        fault_ = error.what();
      }
      ended_ = true;
    });
  }
  ~SharedHand() { end(); }
  SharedHand(const SharedHand&) = delete;
  SharedHand& operator=(const SharedHand&) = delete;

  ToldHand& device() { return device_; }
  const Model& model() const { return session_.model(); }
  SharedCounts counts() const { return session_.shared()->counts(); }
  /// A position without contact.
  DVec3 farPlace() const {
    const Bounds box = boundsOf(model().cloud);
    return model().cloud.origin + box.center() + DVec3(0, 0, 3 * std::max(box.longestSide(), 1e-3));
  }
  /// Throws if the hand has already ended.
  void check() {
    if (!ended_) return;
    end();
    session_.checkFollower();
    throw Error("a hand of the bench ended early: {}", fault_.empty() ? "its time was over" : fault_);
  }
  /// Ends the hand and returns its result.
  const ServoResult& end() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    return result_;
  }
  void finish() { session_.finish(); }
  /// Own edits that were dropped and others' edits that were postponed because an edit took too long.
  std::uint64_t editsTooSlow() const {
    const TouchShortfalls& shortfalls = session_.backend().report().shortfalls;
    return shortfalls.editsTooSlow + shortfalls.offersTooSlow;
  }

 private:
  SessionConfig config_;
  Session session_;
  ToldHand device_;
  ServoResult result_;
  std::string fault_;
  std::atomic<bool> stop_ = false, ended_ = false;
  std::jthread thread_;
};

SessionConfig configOf(const ShareOptions& share, const std::string& backend, double duration_s) {
  SessionConfig config;
  config.model.file = share.name;
  config.model.join =
      JoinConfig{.network = share.network.interface, .peers = share.network.peers, .domain = share.network.domain};
  config.backend.name = backend;
  config.realtime = true;
  config.duration_s = duration_s;
  return config;
}

/// Serves a sphere for its lifetime.
class OwnServer {
 public:
  OwnServer(const ShareOptions& share, unsigned threads)
      : cloud_(
            sampleShape(*makeShape("sphere"), {.count = static_cast<std::size_t>(share.points), .threads = threads})),
        server_(cloud_, {.network = share.network.config(), .name = share.name, .model = "a sphere", .mm_per_unit = 1}),
        thread_([this] { server_.serve(stop_); }) {}
  ~OwnServer() { stop_ = true; }
  OwnServer(const OwnServer&) = delete;
  OwnServer& operator=(const OwnServer&) = delete;

 private:
  std::atomic<bool> stop_ = false;
  PointCloud cloud_;
  CloudServer server_;
  std::jthread thread_;
};

template <class Sign>
bool waitFor(double most_s, SharedHand& a, SharedHand& b, Sign&& sign) {
  for (const Stopwatch since; !sign(); std::this_thread::sleep_for(std::chrono::microseconds(500))) {
    a.check();
    b.check();
    if (StopBySignal::requested()) throw Error("interrupted");
    if (since.elapsed_s() > most_s) return false;
  }
  return true;
}

struct Felt {
  std::vector<double> after_ms;
  std::uint64_t notFelt = 0;     // within the time of a round trip of two seconds, lost twice
  std::uint64_t notPressed = 0;  // the presser made no edit: there was nothing to feel
  std::uint64_t unsteady = 0;    // positions on which the hand did not settle
};

// Each trial uses another position, unaffected by earlier edits, and a random delay, out of phase with any periodic
// process.
Felt pressAndRest(SharedHand& presser, SharedHand& rester, std::int64_t trials) {
  const PointCloud& cloud = rester.model().cloud;
  const double mm = 1 / rester.model().scale.mm_per_unit;
  std::mt19937 random(7);
  Felt felt;
  for (std::int64_t trial = 0; trial < trials; ++trial) {
    const std::size_t point = random() % cloud.size();
    const DVec3 normal(cloud.normals[point]), place = cloud.origin + DVec3(cloud.positions[point]);
    const auto at = [&](double above_mm) { return place + above_mm * mm * normal; };
    rester.device().goTo(at(3), true);
    presser.device().goTo(at(20), true);
    const auto has = [](SharedHand& hand) { return hand.device().arrived_s().has_value(); };
    waitFor(1, presser, rester, [&] { return has(rester) && has(presser); });
    rester.device().goTo(at(-kRest_mm), false);
    const bool isSteady = waitFor(2, presser, rester, [&] {
      const ToldHand::Felt now = rester.device().felt();
      return has(rester) && now.now_s - now.since_s > kSteady_s && glm::length(now.force_N) > 0.1;
    });
    if (!isSteady) {
      ++felt.unsteady;
      continue;
    }
    // Earlier edits have reached every hand.
    constexpr double kPatience_s = 6;
    waitFor(kPatience_s, presser, rester, [&] { return presser.counts().idle && rester.counts().idle; });
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 50'000));
    const std::uint64_t sent = presser.counts().sent;
    rester.device().watch();
    presser.device().goTo(at(-kPress_mm), false);
    if (waitFor(kPatience_s, presser, rester, [&] { return rester.device().changed_s() && has(presser); }))
      felt.after_ms.push_back((*rester.device().changed_s() - *presser.device().arrived_s()) * 1e3);
    else
      ++(presser.counts().sent == sent ? felt.notPressed : felt.notFelt);
    presser.device().goTo(presser.farPlace(), true);
  }
  return felt;
}

/// Result of one back end.
struct ShareRecord {
  std::string backend;
  Felt felt;
  SharedCounts rests, presses;
  double trip_ms = 0;  // round trip, mean of both hands
  std::uint64_t ticks = 0, missed = 0, aged = 0;
  std::uint64_t editsTooSlow = 0;  // of both hands, after their end
  bool same = false;
};

ShareRecord measureShare(Context& context, const ShareOptions& share, const std::string& backend,
                         std::int64_t presses) {
  constexpr double kLongestTrial_s = 4, kLongest_s = 600;
  SessionConfig config =
      configOf(share, backend, std::min(kLongest_s, 10 + kLongestTrial_s * static_cast<double>(presses)));
  const Stopwatch clock;
  SharedHand rester(context, config, "rests", clock);
  config.brush = BrushConfig{.resample = false};
  SharedHand presser(context, config, "presses", clock);
  ShareRecord record{.backend = backend,
                     .felt = pressAndRest(presser, rester, presses),
                     .rests = rester.counts(),
                     .presses = presser.counts()};
  record.trip_ms = (record.rests.link.roundTrip_ms.value_or(0) + record.presses.link.roundTrip_ms.value_or(0)) / 2;
  const ServoResult& result = rester.end();
  presser.end();
  presser.finish();
  rester.finish();
  record.ticks = result.trace().rows.size();
  record.missed = result.trace().missedTicks;
  record.aged = result.counts().withheld.aged;
  record.editsTooSlow = presser.editsTooSlow() + rester.editsTooSlow();
  record.same = rester.counts().same && presser.counts().same;
  return record;
}

Summary beyondTrip_ms(const ShareRecord& record) {
  std::vector<double> beyond_ms;
  for (const double each_ms : record.felt.after_ms) beyond_ms.push_back(each_ms - record.trip_ms);
  return summarize(beyond_ms);
}

using Value = std::optional<Json>;

constexpr Reported<ShareRecord> kShare[]{
    {"backend", "", "back end", field<&ShareRecord::backend>},
    {"round_trip_ms", "ms", "round trip to the server, mean of both hands", field<&ShareRecord::trip_ms>},
    {"lost_percent", "%", "pings lost; null: no ping was sent",
     [](const ShareRecord& r) -> Value { return orNull(r.rests.link.lost_percent); }},
    {"felt_ms", "ms", "time from the press of one hand to the change of force on the other",
     [](const ShareRecord& r) -> Value { return summaryOf(summarize(r.felt.after_ms)); }},
    {"beyond_ms", "ms", "the same without the round trip",
     [](const ShareRecord& r) -> Value { return summaryOf(beyondTrip_ms(r)); }},
    {"goal_ms", "ms", "its goal", [](const ShareRecord&) -> Value { return kGoal_ms; }},
    {"not_felt", "", "presses that were not felt", [](const ShareRecord& r) -> Value { return r.felt.notFelt; }},
    {"not_pressed", "", "presses without an edit, where there was nothing to feel",
     [](const ShareRecord& r) -> Value { return r.felt.notPressed; }},
    {"unsteady", "", "positions at which the hand did not settle",
     [](const ShareRecord& r) -> Value { return r.felt.unsteady; }},
    {"dropped_edits", "", "edits dropped or postponed because an edit took too long",
     field<&ShareRecord::editsTooSlow>},
    {"ticks", "", "ticks of the resting hand", field<&ShareRecord::ticks>},
    {"missed_ticks", "", "ticks skipped because their time had passed", field<&ShareRecord::missed>},
    {"aged_ticks", "", "ticks with reduced force, as the server was silent", field<&ShareRecord::aged>},
    {"same", "", "whether the points of both hands equal the server's", field<&ShareRecord::same>},
};

Json benchShare(Context& context, const BenchOptions& options, const ShareOptions& share) {
  Json records = Json::array();
  for (const std::string& backend : options.backends)
    records.push_back(jsonBy(kShare, measureShare(context, share, backend, options.repeat)));
  printTables(context.tables(), "share", records);
  return records;
}

}  // namespace

void listShareBenchResults(std::vector<ResultFacts>& all) {
  constexpr DescribedKey records[]{{"share", "", "one for each back end"}};
  listResults(all, "bench share", "", records);
  listAlone(all, "share", "[].", kShare);
}

void addShareBench(Options& bench, Context& context, Command& command) {
  Options& sub = bench.addSubcommand("share", "time until one hand's edit of a shared cloud is felt by another");
  const auto options = std::make_shared<BenchOptions>();
  const auto share = std::make_shared<ShareOptions>();
  options->backends = {"cpu"};
  options->repeat = 50;
  sub.add("--join", share->name,
          "name of a session that another palpate serves (default: this program serves a sphere)")
      .typeName("NAME");
  sub.add("--points", share->points, "points of that sphere").check(wholeBetween(1000, 1e7)).showDefault();
  addNetworkOptions(sub, share->network);
  addBackendsOption(sub, *options, {"cpu", "vulkan"});
  sub.add("--presses", options->repeat, "number of presses").check(wholeBetween(1, 10'000)).showDefault();
  sub.footer(
      "Both hands belong to this program, at 1 kHz. The time is from the tick at which one hand presses to the first "
      "change of force on the hand that rests there. The edit goes to the server and back, so that the time includes a "
      "round trip, as between two hands each half a round trip from the server. \"Beyond it\" is the time without that "
      "round trip.\n");
  sub.whenNamed([&, options, share] {
    command = [&context, options, share] {
      const StopBySignal stop;
      std::optional<OwnServer> server;
      if (share->name.empty()) {
        share->name = fmt::format("bench share {:08x}", std::random_device()());
        server.emplace(*share, context.threads());
      }
      measureAlone(context, *options, "share", [&] { return benchShare(context, *options, *share); });
    };
  });
}

}  // namespace palpate
