// ctest: waits
// A shared session as seen by a session: its behaviour while the others are silent, and at its end.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/core/clock.hpp"
#include "tests/near.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::shared_session_test {

namespace {

/// The others, controlled by a test.
class Others final : public SharedFollower {
 public:
  struct State {
    std::optional<InformationAge> known{std::in_place};
    SharedCounts counts{.delivered = true, .idle = true, .same = true};
    bool inEffectEachTime = false;  // at each query of the counts
    bool answers = true;            // whether the server answers queries of its state
    bool isHeardEachTime = false;
    std::optional<double> takesAfter_s;  // from the first look on
    Stopwatch since;
    std::size_t asked = 0;
    HandPlaces places;
    std::size_t moves = 0;
  };
  explicit Others(State& state) : state_(state) {}
  void catchUp(const EditBatch&) override {}
  const InformationAge& known() const override { return *state_.known; }
  SharedCounts counts() const override {
    state_.counts.inEffect += state_.inEffectEachTime;
    if (state_.isHeardEachTime) state_.known->heard();
    if (state_.takesAfter_s) state_.counts.delivered = state_.since.elapsed_s() >= *state_.takesAfter_s;
    return state_.counts;
  }
  void askServer() override {
    ++state_.asked;
    state_.counts.idle = state_.counts.same = state_.answers;
  }
  void moved(const HandPlaces& hands) noexcept override {
    state_.places = hands;
    ++state_.moves;
  }
  std::vector<std::string> takeSaid() override { return {}; }

 private:
  State& state_;
};

/// Receives the hands' positions.
class Told final : public SharedPresence {
 public:
  void moved(const HandPlaces& hands) noexcept override {
    places = hands;
    ++moves;
  }
  void show(const std::optional<CameraPlace>&) override {}
  std::vector<SeenHand> hands() const override { return {}; }
  std::vector<SeenCamera> cameras() const override { return {}; }
  HandPlaces places;
  std::size_t moves = 0;
};

Model sharedSphere(Others::State& others) {
  Model model = sphereModel();
  model.source = JoinedPoints{
      .share = [&](const PointCloud&, TouchBackend&) { return std::make_unique<Others>(others); }, .presence = nullptr};
  return model;
}

SessionConfig joined() { return {.model = {.file = "shared", .join = JoinConfig{}}, .backend = {.name = "cpu"}}; }

/// Ticks of 1 ms at a distance from the sphere's centre; returns the last force, N.
class Puller {
 public:
  explicit Puller(Session& session) : session_(session) { session_.pull({}); }
  double at(double distance, int ticks) {
    double force_N = 0;
    for (int i = 0; i < ticks; ++i) {
      const Pose pose{.time_s = 1e-3 * tick_++, .hip = DVec3(0, 0, distance)};
      force_N = glm::length(session_.tick({&pose, 1}).front().force_N);
    }
    return force_N;
  }

 private:
  Session& session_;
  int tick_ = 0;
};

}  // namespace

TEST_CASE("a pulled hand loses its force while the server is silent, and regains it after leaving the surface") {
  Others::State others;
  const auto cpu = cpuBackend();
  Session session(joined(), sharedSphere(others), {.backend = *cpu});
  Puller hand(session);
  hand.at(52, 10);
  CHECK(hand.at(49, 100) > 0.5);
  CHECK(others.moves == 110);
  CHECK(others.places.count == 1);
  const HandPlace& place = others.places.hands[0];
  CHECK(place.touching);
  CHECK(place.position == DVec3(0, 0, 49));
  CHECK(glm::length(place.proxy) == within(49.82, 0.01));  // with so few points the averaged surface is 0.18 deep
  CHECK_FALSE(place.sculpts);
  others.known.emplace(InformationAge::Clock::now() - std::chrono::minutes(1));
  CHECK(hand.at(49, 1) > 0);  // it fades at a limited rate
  CHECK(hand.at(49, 100) == 0);
  others.known.emplace();
  CHECK(hand.at(49, 1000) == 0);  // the surface would push at once
  hand.at(52, 10);
  const double soon_N = hand.at(49, 30), later_N = hand.at(49, 1000);
  CHECK(soon_N > 0);
  CHECK(soon_N < 0.2 * later_N);
  CHECK(later_N > 0.5);
}

TEST_CASE("the others receive all hands of a session that cannot sculpt, by path and by pulled ticks") {
  const auto told = std::make_shared<Told>();
  const auto cpu = cpuBackend();
  Model model = sphereModel();
  model.source = JoinedPoints{.share = {}, .presence = told};
  SessionConfig config = joined();
  config.hands.resize(2);
  config.duration_s = 0.1;
  Session session(config, std::move(model), {.backend = *cpu});
  CHECK(session.presence() == told.get());
  const std::array<PathHand, 2> paths{PathHand(Path({{0, {0, 0, 52}}, {0.05, {0, 0, 49}}, {0.1, {0, 0, 49}}})),
                                      PathHand(Path({{0, {60, 0, 0}}, {0.1, {60, 0, 0}}}))};
  const std::array<OpenHand, 2> hands{paths[0].hand(), paths[1].hand()};
  session.run(hands, {});
  CHECK(told->moves == 101);
  const auto areTold = [&] {
    REQUIRE(told->places.count == 2);
    const auto& [first, second] = std::pair(told->places.hands[0], told->places.hands[1]);
    CHECK(first.touching);
    CHECK(first.position == DVec3(0, 0, 49));
    CHECK(glm::length(first.proxy) == within(49.82, 0.01));
    CHECK_FALSE(first.sculpts);
    CHECK_FALSE(second.touching);
    CHECK(second.position == DVec3(60, 0, 0));
    CHECK(second.proxy == second.position);
  };
  areTold();
  told->places = {};
  session.pull({});
  for (int i = 0; i < 50; ++i) {
    const std::array<Pose, 2> poses{Pose{.time_s = 1 + 1e-3 * i, .hip = {0, 0, 52 - 0.1 * std::min(i, 30)}},
                                    Pose{.time_s = 1 + 1e-3 * i, .hip = {60, 0, 0}}};
    session.tick(poses);
  }
  CHECK(told->moves == 151);
  areTold();
}

TEST_CASE("a hand in a session with a responsive server feels what it would feel alone") {
  Others::State others;
  const auto cpu = cpuBackend();
  Session shared(joined(), sharedSphere(others), {.backend = *cpu}),
      alone({.backend = {.name = "cpu"}}, sphereModel(), {.backend = *cpu});
  Puller one(shared), two(alone);
  for (const double distance : {52.0, 49.5, 48.0, 51.0}) CHECK(one.at(distance, 20) == two.at(distance, 20));
}

TEST_CASE("a session waits for the others up to its limit, and not if their part has ended") {
  Others::State others;
  others.counts = {};
  const auto cpu = cpuBackend();
  Session session(joined(), sharedSphere(others), {.backend = *cpu, .sharedPatience_s = 0.3});
  const Stopwatch waited;
  session.finish();
  CHECK(waited.elapsed_s() >= 0.3);
  CHECK(waited.elapsed_s() < 3);
  others.counts.fault = "it is over";
  const Stopwatch over;
  CHECK_FALSE(session.settleShared(60));
  CHECK(over.elapsed_s() < 3);
}

TEST_CASE("a session that must settle completely asks the server even if the last result says settled") {
  Others::State others;
  const auto cpu = cpuBackend();
  Session session(joined(), sharedSphere(others), {.backend = *cpu});
  CHECK(session.settleShared(60));  // according to the last result
  CHECK(others.asked == 0);
  CHECK(session.settleShared(60, Session::Settling::all));
  CHECK(others.asked == 1);
  others.answers = false;
  const Stopwatch waited;
  CHECK_FALSE(session.settleShared(0.3, Session::Settling::all));
  CHECK(waited.elapsed_s() >= 0.3);
  CHECK(others.asked == 2);
}

TEST_CASE("an ending session waits for a slow but responsive server, and reports what is not confirmed") {
  struct Heard final : LogListener {
    void said(std::string_view line) override { lines.emplace_back(line); }
    void progressed(std::string_view, double) override {}
    std::vector<std::string> lines;
  } heard;
  Log log(true);
  log.listen(&heard);
  Others::State others;
  const auto cpu = cpuBackend();
  Session session(joined(), sharedSphere(others), {.backend = *cpu, .log = &log});
  others.takesAfter_s = 0.5;
  others.isHeardEachTime = true;
  others.since = {};
  CHECK(session.deliver(60, 0.1));
  CHECK(others.since.elapsed_s() >= 0.5);
  CHECK(heard.lines.empty());
  // Not longer than its limit, and not if the server is silent.
  others.takesAfter_s = 1e9;
  const Stopwatch patient;
  CHECK_FALSE(session.deliver(0.3, 0.1));
  CHECK(patient.elapsed_s() >= 0.3);
  REQUIRE(heard.lines.size() == 1);
  CHECK(heard.lines[0].find("has not confirmed") != std::string::npos);
  others.isHeardEachTime = false;
  others.known.emplace(InformationAge::Clock::now() - std::chrono::minutes(1));
  const Stopwatch silent;
  CHECK_FALSE(session.deliver(60, 0.1));
  CHECK(silent.elapsed_s() < 20);
  CHECK(heard.lines.size() == 2);
}

TEST_CASE("a session waits for the edits of others so far, and for later ones only on request") {
  Others::State others;
  others.counts = {.delivered = true};
  const auto cpu = cpuBackend();
  Session session(joined(), sharedSphere(others), {.backend = *cpu});
  const Stopwatch unheard;
  CHECK_FALSE(session.settleShared(2));  // no edits of the others are known yet
  CHECK(unheard.elapsed_s() >= 2);
  others.inEffectEachTime = true;
  others.answers = false;
  const Stopwatch known;
  CHECK_FALSE(session.settleShared(60));
  CHECK(known.elapsed_s() < 10);
  const Stopwatch all;
  CHECK_FALSE(session.settleShared(2, Session::Settling::all));
  CHECK(all.elapsed_s() >= 2);
}

}  // namespace palpate::shared_session_test
