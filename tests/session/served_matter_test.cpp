// Water and sand that a server simulates for hands on other machines, and the data sent to them, without a network.
#include <doctest/doctest.h>

#include <map>

#include "engine/core/clock.hpp"
#include "engine/matter/matter_model.hpp"
#include "engine/motion/brick_source.hpp"
#include "engine/touch/brick_matter.hpp"
#include "haptics/session/matter_scenes.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/stepped_model.hpp"

namespace palpate::served_matter_test {

namespace {

MatterScene pool() {
  MatterScene scene{.box_mm = {80, 120, 80}, .fill_mm = {80, 70, 80}, .spacing_mm = 10};
  scene.tool = {.radius_mm = 20, .mass_kg = 0.034};
  return scene;
}

class Lines final : public LogListener {
 public:
  void said(std::string_view line) override { lines.emplace_back(line); }
  void progressed(std::string_view, double) override {}
  std::vector<std::string> lines;
};

/// A model stepped by its own clock, so that no machine is too slow.
class Served {
 public:
  explicit Served(const MatterScene& scene) {
    log_.listen(&lines_);
    SessionConfig config{.model = {.file = "pool"}, .backend = {.name = "cpu"}};
    config.matter = scene;
    config.realtime = true;
    model_ = std::make_shared<const Model>(loadModel(config, {.log = log_, .threads = 1}));
    stepped_.emplace(config, model_, SteppedModel::Parts{.backend = *cpu_, .threads = 1, .log = &log_});
  }
  /// Steps until `holds` is true of a frame, for at most `seconds` of real time.
  bool until(double seconds, const std::vector<SeenHand>& hands, const std::function<bool(const CloudFrame&)>& holds) {
    CloudFrame frame;
    for (const Stopwatch since; since.elapsed_s() < seconds;) {
      time_s_ += 1 / stepped_->rate_Hz();
      if (stepped_->step(time_s_, hands, frame) && holds(frame)) return true;
    }
    return false;
  }
  const Model& model() const { return *model_; }
  const std::vector<std::string>& said() const { return lines_.lines; }
  Restarts restarts() const { return stepped_->restarts(); }

 private:
  Lines lines_;
  Log log_{true};
  std::unique_ptr<BackendKind> cpu_ = cpuBackend();
  std::shared_ptr<const Model> model_;
  std::optional<SteppedModel> stepped_;
  double time_s_ = 0;
};

std::size_t within(const CloudFrame& frame, const DVec3& place, double radius) {
  std::size_t count = 0;
  for (const Vec3& position : frame.positions) count += glm::distance(DVec3(position), place) < radius;
  return count;
}

SeenHand handAt(std::uint32_t number, const DVec3& place) {
  SeenHand hand{.number = number};
  hand.place.position = hand.place.proxy = place;
  return hand;
}

}  // namespace

TEST_CASE("each connected hand has a ball in the water where it is put down, and none after it leaves") {
  Served served(pool());
  const DVec3 a(25, 30, 40), b(55, 30, 40);
  CHECK(served.until(60, {}, [&](const CloudFrame& frame) {
    REQUIRE(frame.size() == served.model().cloud.size());
    REQUIRE(frame.velocities.size() == frame.size());
    return within(frame, a, 15) > 5;
  }));
  CHECK(served.until(120, {handAt(1, a)}, [&](const CloudFrame& frame) { return within(frame, a, 17) == 0; }));
  CHECK(served.until(120, {handAt(7, b)},
                     [&](const CloudFrame& frame) { return within(frame, b, 17) == 0 && within(frame, a, 15) > 5; }));
  // A hand that jumps is put down at its new position: matter between the positions is not moved.
  CHECK(served.until(120, {handAt(7, a)},
                     [&](const CloudFrame& frame) { return within(frame, a, 17) == 0 && within(frame, b, 15) > 5; }));
  CHECK(served.said().empty());
}

TEST_CASE("more hands than balls, and hands that jump about, do not end served water") {
  Served served(pool());
  std::uint32_t round = 0;
  for (int times = 0; times < 20; ++times) {
    std::vector<SeenHand> hands;
    for (std::uint32_t k = 0; k < 12; ++k) {
      ++round;
      hands.push_back(handAt(k, DVec3(round * 37 % 80, round * 53 % 110, round * 71 % 80)));
    }
    int frames = 0;
    CHECK(served.until(60, hands, [&](const CloudFrame& frame) {
      for (const Vec3& position : frame.positions) REQUIRE(isFinite(position));
      return ++frames == 3;
    }));
  }
  // It continues, whether or not it has restarted.
  CHECK(served.until(120, {}, [&](const CloudFrame& frame) { return within(frame, DVec3(40, 20, 40), 15) > 5; }));
}

TEST_CASE("water that fails restarts, and each restart is counted and reported with its reason") {
  // So fine and weightless that its speed of sound is below the speed of the hand. On a slow machine a frame covers
  // less time, so that the hand stays longer on each side, the longer it takes.
  MatterScene scene{.box_mm = DVec3(16), .fill_mm = DVec3(16), .spacing_mm = 2, .gravity_m_s2 = DVec3(0)};
  scene.tool = usualTool(scene);
  Served served(scene);
  CHECK(served.restarts().count == 0);
  int frames = 0;
  for (int beats = 0; frames < 4000 && served.said().size() < 2; ++beats)
    for (int stay = 0; stay <= beats / 100; ++stay, ++frames)
      served.until(10, {handAt(1, {8, beats % 2 ? 18 : -2, 8})}, [](const CloudFrame&) { return true; });
  MESSAGE(fmt::format("after {} frames: {}", frames, fmt::join(served.said(), "; ")));
  REQUIRE(served.said().size() == 2);
  CHECK(served.restarts().count == 2);
  CHECK(served.said()[1] == "the simulation " + served.restarts().why + ": it is restarted");
}

TEST_CASE("a body that stands in water is not part of the frames") {
  MatterScene scene = pool();
  scene.model = "builtin:sphere";
  scene.model_mm = DVec3(50);
  Served served(scene);
  REQUIRE(served.model().standing());
  const std::size_t standing = served.model().standing()->points().size();
  REQUIRE(standing > 1000);
  CHECK(served.until(60, {}, [&](const CloudFrame& frame) {
    CHECK(frame.size() == served.model().cloud.size() - standing);
    CHECK(frame.normals.size() == frame.size());
    CHECK(frame.velocities.size() == frame.size());
    return true;
  }));
}

namespace {

/// Water simulated elsewhere, at rest.
class RestingFar final : public FarCloud {
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
  config.join = JoinConfig{};
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
  return loadModel(config, loading);
}

}  // namespace

TEST_CASE("joined water is felt as water, shown as particles, and not felt where it is unknown") {
  const auto cpu = cpuBackend();
  SessionConfig config{.model = {.file = "pool"}, .backend = {.name = "cpu"}};
  config.join = JoinConfig{};
  config.realtime = true;
  Session session(config, joinedPool(sceneText(pool())), {.backend = *cpu, .threads = 1});
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
  CHECK_THROWS_WITH_AS(joinedPool(sceneText(*matterScene("jelly"))), doctest::Contains("soft body"), Error);
  MatterScene scene = pool();
  scene.spacing_mm = 1e-9;
  CHECK_THROWS_AS(joinedPool(sceneText(scene)), Error);
  CHECK_THROWS_WITH_AS(joinedPool(sceneText(pool()), 1'000'000), doctest::Contains("are missing"), Error);
}

TEST_CASE("a scene is sent as text, and an invalid text is refused") {
  for (const char* name : {"water", "dam", "sand", "drop"}) {
    MatterScene scene = *matterScene(name);
    CHECK(parseScene(sceneText(scene)) == scene);
    CHECK(sceneText(scene).size() < 1500);
  }
  CHECK_THROWS_AS(parseScene("{"), Error);
  CHECK_THROWS_AS(parseScene("{\"matter\": \"fire\"}"), Error);
  MatterScene scene = *matterScene("water");
  scene.spacing_mm = -1;
  CHECK_THROWS_AS(parseScene(sceneText(scene)), Error);
  scene = *matterScene("water");
  scene.tool.radius_mm = 0;
  CHECK_THROWS_AS(parseScene(sceneText(scene)), Error);
}

}  // namespace palpate::served_matter_test
