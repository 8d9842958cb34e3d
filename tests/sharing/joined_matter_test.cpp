// Water and sand that another program simulates, felt by the forces that it sends, without a network.
#include <doctest/doctest.h>

#include <deque>
#include <map>
#include <random>

#include "engine/core/named_values.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/late_force.hpp"
#include "haptics/simulation/matter_choice.hpp"
#include "haptics/simulation/simulator.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"

namespace palpate::joined_matter_test {

namespace {

MatterScene pool() {
  MatterScene scene{.box_mm = {80, 120, 80}, .fill_mm = {80, 70, 80}, .spacing_mm = 10};
  scene.tool = {.radius_mm = 20, .mass_kg = 0.034};
  return scene;
}

/// Water simulated elsewhere, at rest.
class RestingFar final : public BrickCloud {
 public:
  explicit RestingFar(const MatterScene& scene)
      : source_({.edge = 4 * scene.spacing_mm, .points = 1 << 14, .moves = true}) {
    std::map<BrickKey, std::shared_ptr<Brick>> bricks;
    // Empty bricks are known, too: all of the box, and beyond.
    source_.grid().boxOf(-DVec3(100), scene.box_mm + 100.0).forEach([&](const IVec3& brick) {
      bricks[BrickGrid::keyOf(brick)] = std::make_shared<Brick>();
    });
    std::uint32_t id = 0;
    for (const Vec3& place_m : placesAtRest(scene)) {
      const Vec3 place = 1e3f * place_m;
      Brick& brick = *bricks[source_.grid().keyAt(DVec3(place))];
      brick.ids.push_back(id++);
      brick.positions.push_back(place);
      brick.normals.emplace_back(0, 1, 0);
      brick.velocities.emplace_back(0);
    }
    BrickUpdate update{.true_s = steadyNow_s(), .whole = true};
    for (const auto& [key, brick] : bricks) update.bricks.emplace_back(key, blockOf(brick));
    source_.apply(std::move(update));
  }
  /// Sends a force on the first hand, true for that time.
  void send(const DVec3& force_N, double true_s) {
    BrickUpdate update{.true_s = true_s, .whole = true};
    update.force_N[0] = Vec3(force_N);
    source_.apply(std::move(update));
  }
  void setRoundTrip(double roundTrip_s) { known_.setRoundTrip(roundTrip_s); }
  BrickSource& source() override { return source_; }
  bool moves() const override { return source_.moves(); }
  const InformationAge& known() const override { return known_; }
  bool isSculptable() const override { return false; }
  FarCounts counts() const override { return {}; }
  void check() const override {}
  std::vector<std::string> takeSaid() override { return {}; }

 private:
  BrickSource source_;
  InformationAge known_;
};

/// The model of a client that has joined.
Model joinedPool(const std::string& matter, std::uint64_t standing = 0, std::shared_ptr<RestingFar> far = nullptr) {
  SessionConfig config{.model = {.file = "pool"}, .backend = {.name = "cpu"}};
  config.model.join = JoinConfig{};
  Log log(true);
  const MatterScene scene = pool();
  JoinedModel joined;
  for (const Vec3& place_m : placesAtRest(scene)) {
    joined.cloud.positions.push_back(1e3f * place_m);
    joined.cloud.normals.emplace_back(0, 1, 0);
  }
  joined.cloud.storedAs.comments = {"comment mm_per_unit: 1"};
  joined.far = far ? far : std::make_shared<RestingFar>(scene);
  joined.facts = FarFacts{.extent = {.bounds = boundsOf(joined.cloud), .points = joined.cloud.size()},
                          .spacing = scene.spacing_mm,
                          .edge = 4 * scene.spacing_mm,
                          .moves = true,
                          .matter = matter,
                          .standing = standing};
  const ModelLoading loading{
      .log = log, .threads = 1, .join = [&](const std::string&, const JoinConfig&, Log&) { return joined; }};
  return loadModel(config.model, loading);
}

MatterScene sandOf(MatterScene scene) {
  scene.density_kg_m3 = 1600;
  scene.viscosity_Pa_s = MatterScene{}.viscosity_Pa_s;
  scene.tool.mass_kg = 0.06;
  return scene;
}

/// A session that has joined it, on a clock of its own.
class Joined {
 public:
  explicit Joined(const MatterScene& scene) : far_(std::make_shared<RestingFar>(scene)) {
    SessionConfig config{.model = {.file = "pool"}, .backend = {.name = "cpu"}};
    config.model.join = JoinConfig{};
    config.realtime = true;
    session_.emplace(config, joinedPool(sceneRef(scene)->text(), 0, far_),
                     SessionParts{.backend = *cpu_, .threads = 1});
  }
  Session& session() { return *session_; }
  RestingFar& far() { return *far_; }
  Contact ask(const DVec3& hip) { return session_->backend().query({.time_s = 1e-3 * ++ticks_, .hip = hip}, 20'000); }
  /// Until the particles around the hand are there.
  void settle(const DVec3& hip) {
    for (int k = 0; k < 3; ++k) session_->backend().query({.time_s = 1e-3 * ++ticks_, .hip = hip}, 0);
  }

 private:
  std::unique_ptr<BackendKind> cpu_ = cpuBackend();
  std::shared_ptr<RestingFar> far_;
  std::optional<Session> session_;
  int ticks_ = 0;
};

/// The simulation at the server, with the hand and the forces on it 60 times a second over a link.
class Link {
 public:
  /// `delay_s`: in each direction.
  Link(const MatterScene& scene, double delay_s)
      : delay_(std::lround(delay_s / kMatterStep_s)),
        world_(simulatorOf(*cpuBackend()).simulate(scene, {.threads = 1, .tools = 1})) {}

  void step(const DVec3& hip, RestingFar& far) {
    constexpr int kApart = 16;
    constexpr double kBetweenPlaces_s = 0.02;  // with which the server follows a hand
    if (steps_ % kApart == 0) places_.push_back({steps_ + delay_, 1e-3 * hip});
    for (; !places_.empty() && places_.front().first <= steps_; places_.pop_front()) {
      if (!known_m_) hand_.place_m = places_.front().second;
      known_m_ = places_.front().second;
    }
    if (known_m_) {
      hand_.place_m += (*known_m_ - hand_.place_m) * (1 - std::exp(-kMatterStep_s / kBetweenPlaces_s));
      world_->step({&hand_, 1});
      if (steps_ % kApart == 0) forces_.push_back({steps_ + delay_, world_->answers()[0].force_N});
    }
    for (; !forces_.empty() && forces_.front().first <= steps_; forces_.pop_front())
      far.send(forces_.front().second, steadyNow_s());
    ++steps_;
  }

 private:
  long delay_, steps_ = 0;
  std::unique_ptr<MatterSimulation> world_;
  HandPose hand_;
  std::optional<DVec3> known_m_;
  std::deque<std::pair<long, DVec3>> places_, forces_;
};

}  // namespace

TEST_CASE("joined water is felt as water, shown as particles, and not felt where it is unknown") {
  Joined joined(pool());
  Session& session = joined.session();
  CHECK(session.model().discRadius() > 0);
  CHECK(session.model().ballRadius() == 20);
  REQUIRE(session.model().container());
  const DVec3 hip(40, 35, 40), away(40, 35, 5000);
  const double expected_N = 1000 * 9.81 * 4 * 3.14159265 / 3 * 8e-6;
  joined.settle(hip);
  Link link(pool(), 0);
  double mean_N = 0;
  for (int k = 0; k < 900; ++k) {
    const Contact contact = joined.ask(hip);
    REQUIRE(contact.valid);
    link.step(hip, joined.far());
    if (k >= 600) mean_N += contact.force_N.value_or(DVec3(0)).y / 300;
  }
  MESSAGE(fmt::format("held in joined water: {:.3f} N of {:.3f} N displaced", mean_N, expected_N));
  CHECK(mean_N > 0.75 * expected_N);
  CHECK(mean_N < 1.25 * expected_N);
  CloudFrame frame;
  CHECK(session.backend().frames()->take(frame));
  CHECK(frame.size() > 200);
  CHECK(frame.size() <= session.model().cloud.size());
  CHECK(frame.colors.size() == frame.size());
  CHECK(frame.velocities.size() == frame.size());
  for (const Vec3& position : frame.positions) REQUIRE(glm::all(glm::lessThanEqual(DVec3(position), pool().box_mm)));
  const SculptedCloud present = session.sculpted();
  CHECK(present.cloud.size() == frame.size());
  CHECK(present.cloud.colors.size() == frame.size());
  const UnknownTicks before = session.unknownTicks();
  for (int k = 0; k < 20; ++k) {
    const Contact contact = joined.ask(away);
    CHECK_FALSE(contact.touching);
    CHECK(contact.force_N.value_or(DVec3(0)) == DVec3(0));
  }
  CHECK(session.unknownTicks().without >= before.without + 20);
}

TEST_CASE("random hands gain at most 0.5 mJ from joined water and sand, over 0, 50 and 500 ms each way" * kMoreInFull) {
  std::mt19937 random(11);
  std::normal_distribution<double> push;
  for (const Matter matter : {Matter::water, Matter::sand})
    for (const double delay_s : {0.0, 0.05, 0.5}) {
      MatterScene scene = pool();
      scene.matter = matter;
      if (matter == Matter::sand) scene = sandOf(scene);
      Joined joined(scene);
      Link link(scene, delay_s);
      DVec3 hip(40, 100, 40), speed_m_s(0), force_N(0);
      joined.settle(hip);
      double energy_mJ = 0, least_mJ = 0, most_N = 0;
      const int steps = byTier(700, 3000) + static_cast<int>(2e3 * delay_s);
      for (int k = 0; k < steps; ++k) {
        speed_m_s = 0.98 * speed_m_s - DVec3(0, 8e-3, 0);
        for (int axis = 0; axis < 3; ++axis) speed_m_s[axis] += 0.05 * push(random);
        const DVec3 last = std::exchange(hip, glm::clamp(hip + speed_m_s, DVec3(22), DVec3(58, 100, 58)));
        energy_mJ -= glm::dot(force_N, hip - last);  // the force acts until the next tick
        least_mJ = std::min(least_mJ, energy_mJ);
        const Contact contact = joined.ask(hip);
        force_N = contact.force_N.value_or(DVec3(0));
        REQUIRE(isFinite(force_N));
        most_N = std::max(most_N, glm::length(force_N));
        link.step(hip, joined.far());
      }
      MESSAGE(fmt::format("random hands in {}, {:.0f} ms each way: least energy {:.3f} mJ, at most {:.2f} N",
                          nameOf(kMatters, matter), 1e3 * delay_s, least_mJ, most_N));
      CHECK(least_mJ >= -0.5);
      CHECK(most_N > 0.1);
    }
}

TEST_CASE("a late force gives a hand at most 0.5 mJ, whatever it is, and stays finite and limited") {
  std::mt19937 random(3);
  std::normal_distribution<double> push;
  for (const double wanted_N : {0.5, 20.0, 1e30}) {
    LateForce late;
    DVec3 place(0), way(0), force_N(0);
    double energy_mJ = 0, least_mJ = 0;
    for (int k = 0; k < 20'000; ++k) {
      for (int axis = 0; axis < 3; ++axis) way[axis] = 0.97 * way[axis] + 0.02 * push(random);
      place += way;
      energy_mJ -= glm::dot(force_N, way);
      least_mJ = std::min(least_mJ, energy_mJ);
      // It helps the hand nine times of ten, and then resists it.
      force_N = late.at(place, 1, (k / 100 % 10 == 9 ? -wanted_N : wanted_N) * glm::normalize(way));
      REQUIRE(isFinite(force_N));
      REQUIRE(glm::length(force_N) <= LateForce::kMax_N * (1 + 1e-9));
    }
    CHECK(least_mJ < -0.3);
    CHECK(least_mJ >= -0.5);
  }
}

TEST_CASE("a hand that a late force accelerates as fast as it may takes at most 0.5 mJ") {
  for (const double wanted_N : {0.5, 3.0, 50.0}) {
    LateForce late;
    double y = 0, way = 0, energy_mJ = 0;
    for (int k = 0; k < 50; ++k) {
      const double force_N = late.at({0, y, 0}, 1, {0, wanted_N, 0}).y;
      way += LateForce::kFarther_mm;
      y += way;
      energy_mJ -= force_N * way;
      REQUIRE(energy_mJ >= -0.5);
    }
    CHECK(energy_mJ < -0.4);
  }
}

TEST_CASE("a hand that sinks into joined matter again feels it, though it had taken all that it may") {
  LateForce late;
  double y = 0;
  for (; y < 30; y += 0.1) late.at({0, y, 0}, 1, {0, 1, 0});
  CHECK(glm::length(late.at({0, y, 0}, 1, {0, 1, 0})) < 0.1);
  for (double down = 0; down < 8; down += 0.05, y -= 0.05) late.at({0, y, 0}, 1, {0, 1, 0});
  CHECK(late.at({0, y, 0}, 1, {0, 1, 0}).y == near(1, 1e-9));
}

TEST_CASE("a force of joined water fades with its age, and is gone within the promised time if the server ends") {
  Joined joined(pool());
  const DVec3 hip(40, 35, 40);
  const auto feltAt = [&](double age_s) {
    double y_N = 0;
    for (int k = 0; k < 300; ++k) {
      joined.far().send(DVec3(0, 0.5, 0), steadyNow_s() - age_s);
      y_N = joined.ask(hip).force_N.value_or(DVec3(0)).y;
    }
    return y_N;
  };
  joined.settle(hip);
  const AgeLimits limits = joined.far().known().limits();
  CHECK(feltAt(0) == near(0.5, 0.01));
  CHECK(feltAt(limits.full_s - 0.2) == near(0.5, 0.01));
  CHECK(feltAt((limits.full_s + limits.gone_s) / 2) == near(0.25, 0.2));
  CHECK(feltAt(limits.gone_s) == 0);
  CHECK(feltAt(0) == near(0.5, 0.01));
}

TEST_CASE("a hand that is put down elsewhere does not feel the force of its earlier position") {
  Joined joined(pool());
  const DVec3 hip(40, 35, 40), other(40, 60, 40);
  joined.settle(hip);
  const auto feel = [&](double ahead_s) {
    double y_N = 0;
    for (int k = 0; k < 100; ++k) {
      joined.far().send(DVec3(0, 0.5, 0), steadyNow_s() + ahead_s);
      y_N = joined.ask(other).force_N.value_or(DVec3(0)).y;
    }
    return y_N;
  };
  CHECK(feel(0) > 0.4);
  joined.session().backend().resetHand(0);
  CHECK(feel(0) == 0);
  CHECK(feel(joined.far().known().roundTrip_s() + 0.2) > 0.4);
  // A link that has just been made counts as slow until it is measured, and not longer.
  joined.session().backend().resetHand(0);
  CHECK(feel(0.2) == 0);
  joined.far().setRoundTrip(0.01);
  CHECK(feel(0.2) > 0.4);
}

TEST_CASE("invalid water from a server is refused with a reason") {
  CHECK_THROWS_AS(joinedPool("{\"matter\": 3}"), Error);
  CHECK_THROWS_WITH_AS(joinedPool(sceneNamed("jelly")->text()), doctest::Contains("soft body"), Error);
  MatterScene scene = pool();
  scene.spacing_mm = 1e-9;
  CHECK_THROWS_AS(joinedPool(sceneRef(scene)->text()), Error);
  CHECK_THROWS_WITH_AS(joinedPool(sceneRef(pool())->text(), 1'000'000), doctest::Contains("are missing"), Error);
}

}  // namespace palpate::joined_matter_test
