// Water and sand that a server simulates for hands on other machines, and the data sent to them, without a network.
#include <doctest/doctest.h>

#include "engine/core/clock.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/simulation.hpp"
#include "haptics/session/stepped_model.hpp"
#include "haptics/simulation/matter_choice.hpp"
#include "haptics/simulation/scene_names.hpp"

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
    config.model.matter = sceneRef(scene);
    config.realtime = true;
    model_ = std::make_shared<const Model>(loadModel(config.model, {.log = log_, .threads = 1}));
    stepped_.emplace(config, model_, SteppedModel::Parts{.backend = *cpu_, .threads = 1, .log = &log_});
  }
  /// Steps until `holds` is true of a frame, for at most `seconds` of real time.
  bool until(double seconds, std::vector<SeenHand> hands, const std::function<bool(const CloudFrame&)>& holds) {
    CloudFrame frame;
    for (const Stopwatch since; since.elapsed_s() < seconds;) {
      time_s_ += 1 / stepped_->rate_Hz();
      const bool isNew = stepped_->step(time_s_, hands, frame);
      hands_ = hands;
      if (isNew && holds(frame)) return true;
    }
    return false;
  }
  const std::vector<SeenHand>& hands() const { return hands_; }  // after the last step
  const Model& model() const { return *model_; }
  const std::vector<std::string>& said() const { return lines_.lines; }
  Restarts restarts() const { return stepped_->restarts(); }

 private:
  Lines lines_;
  Log log_{true};
  std::unique_ptr<BackendKind> cpu_ = cpuBackend();
  std::shared_ptr<const Model> model_;
  std::optional<SteppedModel> stepped_;
  std::vector<SeenHand> hands_;
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

TEST_CASE("each hand in served water gets the force on its own ball") {
  Served served(pool());
  const double expected_N = 1000 * 9.81 * 4 * 3.14159265 / 3 * 8e-6;
  int frames = 0;
  double below_N = 0;
  CHECK(served.until(60, {handAt(5, {40, 110, 40}), handAt(9, {40, 35, 40})}, [&](const CloudFrame&) {
    CHECK(served.hands()[0].force_N == DVec3(0));
    if (++frames > 40) below_N += served.hands()[1].force_N.y / 20;
    return frames == 60;
  }));
  CHECK(below_N > 0.75 * expected_N);
  CHECK(below_N < 1.25 * expected_N);
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
  // So fine and weightless that its speed of sound is below the speed of the hands, which beat against each other.
  MatterScene scene{.box_mm = DVec3(16), .fill_mm = DVec3(16), .spacing_mm = 2, .gravity_m_s2 = DVec3(0)};
  scene.tool = usualTool(scene);
  Served served(scene);
  CHECK(served.restarts().count == 0);
  // On a slow machine a frame covers less time, so that the hands stay longer on each side, the longer it takes.
  int frames = 0;
  for (int beats = 0; frames < 4000 && served.said().size() < 2; ++beats)
    for (int stay = 0; stay <= beats % 40 / 5; ++stay, ++frames) {
      const auto over = [&](std::uint32_t hand) { return (beats + hand) % 2 ? 18.0 : -2.0; };
      served.until(10,
                   {handAt(1, {over(1), 8, 8}), handAt(2, {8, over(2), 8}), handAt(3, {8, 8, over(3)}),
                    handAt(4, {over(4), 4, 12}), handAt(5, {12, over(5), 4}), handAt(6, {4, 12, over(6)})},
                   [](const CloudFrame&) { return true; });
    }
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
  const std::size_t standing = served.model().standing();
  REQUIRE(standing > 1000);
  CHECK(served.until(60, {}, [&](const CloudFrame& frame) {
    CHECK(frame.size() == served.model().cloud.size() - standing);
    CHECK(frame.normals.size() == frame.size());
    CHECK(frame.velocities.size() == frame.size());
    return true;
  }));
}

namespace {

SceneRef heard(const std::string& text) {
  const SceneRef scene = parseScene("matter", text);
  validate(SessionConfig{.model = {.matter = scene}});
  return scene;
}

}  // namespace

TEST_CASE("a scene is sent as text, and an invalid text is refused") {
  for (const char* name : {"water", "dam", "sand", "drop"}) {
    const SceneRef scene = sceneNamed(name);
    CHECK(heard(scene->servedText()) == scene);
    CHECK(scene->servedText().size() < 1500);
  }
  CHECK_THROWS_AS(heard("{"), Error);
  CHECK_THROWS_AS(heard("{\"matter\": \"fire\"}"), Error);
  MatterScene scene = *matterScene("water");
  scene.spacing_mm = -1;
  CHECK_THROWS_AS(heard(sceneRef(scene)->text()), Error);
  scene = *matterScene("water");
  scene.tool.radius_mm = 0;
  CHECK_THROWS_AS(heard(sceneRef(scene)->text()), Error);
}

}  // namespace palpate::served_matter_test
