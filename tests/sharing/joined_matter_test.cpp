// Water that another program simulates, felt from the particles that it sends, without a network.
#include <doctest/doctest.h>

#include <map>

#include "engine/core/clock.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/sharing/brick_cloud.hpp"
#include "haptics/sharing/brick_matter.hpp"
#include "haptics/simulation/matter_choice.hpp"

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
    for (const auto& [key, brick] : bricks) update.bricks.emplace_back(key, brick);
    source_.apply(std::move(update));
  }
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
Model joinedPool(const std::string& matter, std::uint64_t standing = 0) {
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
  joined.far = std::make_shared<RestingFar>(scene);
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

}  // namespace

TEST_CASE("joined water is felt as water, shown as particles, and not felt where it is unknown") {
  const auto cpu = cpuBackend();
  SessionConfig config{.model = {.file = "pool"}, .backend = {.name = "cpu"}};
  config.model.join = JoinConfig{};
  config.realtime = true;
  Session session(config, joinedPool(sceneRef(pool())->text()), {.backend = *cpu, .threads = 1});
  CHECK(session.model().discRadius() > 0);
  CHECK(session.model().ballRadius() == 20);
  REQUIRE(session.model().container());
  const double scale = session.model().scale.mm_per_unit;
  const DVec3 hip(40, 35, 40), away(40, 35, 5000);
  const double expected_N = 1000 * 9.81 * 4 * 3.14159265 / 3 * 8e-6;
  const Stopwatch since;
  double mean_N = 0;
  int answers = 0, old = 0, ticks = 0;
  const auto ask = [&](const DVec3& place) {
    const Pose pose{.time_s = 1e-3 * ++ticks, .hip = place};  // on a clock for which no machine is too slow
    return session.backend().query(pose, 20'000);
  };
  while (since.elapsed_s() < 90 && answers < 500) {
    const Contact contact = ask(hip);
    REQUIRE(contact.valid);
    if (!contact.fresh) ++old;
    if (!contact.fresh || ++answers <= 300) continue;
    mean_N += contact.force_N.value_or(DVec3(0)).y / 200;
  }
  MESSAGE(
      fmt::format("held in water that rests, joined at {:g} mm a unit: {:.3f} N of {:.3f} N displaced; {} old answers",
                  scale, mean_N, expected_N, old));
  CHECK(answers == 500);
  CHECK(mean_N > 0.75 * expected_N);
  CHECK(mean_N < 1.25 * expected_N);
  CloudFrame frame;
  CHECK(session.backend().frames()->take(frame));
  CHECK(frame.size() > 200);
  CHECK(frame.size() <= session.model().cloud.size());
  CHECK(frame.colors.size() == frame.size());
  for (const Vec3& position : frame.positions) REQUIRE(glm::all(glm::lessThanEqual(DVec3(position), pool().box_mm)));
  const SculptedCloud present = session.sculpted();
  CHECK(present.cloud.size() == frame.size());
  CHECK(present.cloud.colors.size() == frame.size());
  const UnknownTicks before = session.unknownTicks();
  for (int k = 0; k < 20; ++k) {
    const Contact contact = ask(away);
    CHECK_FALSE(contact.touching);
    CHECK(contact.force_N.value_or(DVec3(0)) == DVec3(0));
  }
  CHECK(session.unknownTicks().without >= before.without + 20);
}

TEST_CASE("particles from bricks have the numbers of the whole simulation, in metres, and are reported once") {
  const MatterScene scene = pool();
  RestingFar far(scene);
  const MatterNews news = newsOf(far.source());
  KnownMatter known;
  CHECK_FALSE(news(known));  // no hand has asked yet
  HandReaches hands{.time_s = 1, .steady_s = steadyNow_s(), .count = 1};
  far.source().ask(hands);
  REQUIRE(news(known));
  const std::vector<Vec3> places = placesAtRest(scene);
  REQUIRE(known.size() == places.size());
  REQUIRE(known.velocities.size() == places.size());
  for (std::uint32_t i = 0; i < places.size(); ++i) {
    REQUIRE(known.ids[i] == i);
    REQUIRE(glm::distance(known.positions[i], places[i]) < 1e-6f);
  }
  CHECK_FALSE(news(known));
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
