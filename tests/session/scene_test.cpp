// Masks and fields of a session's points: set, undone in order with strokes, saved, refused and reported.
#include "haptics/session/scene.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <numbers>

#include "tests/error_of.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::scene_test {

namespace {

SessionConfig pushing() {
  SessionConfig config{
      .model = {.file = "sphere.ply"}, .backend = {.name = "cpu"}, .hands = std::vector<HandConfig>(1)};
  config.brush = BrushConfig{.kind = BrushKind::push, .yieldDepth_mm = 0.1, .radius_mm = 10};
  return config;
}

/// Has what the batches contain.
class AttributeFollower final : public EditFollower {
 public:
  explicit AttributeFollower(LayerAttributes& attributes) : attributes_(attributes) {}
  void catchUp(const EditBatch& batch) override {
    for (AttributeChange change : batch.attributes) attributes_.exchange(change);
  }

 private:
  LayerAttributes& attributes_;
};

struct FollowedSession {
  LayerAttributes followed;
  std::unique_ptr<BackendKind> cpu = cpuBackend();
  Session session{
      pushing(),
      sphereModel(),
      {.backend = *cpu, .keepsPoints = true, .undo = {1 << 26}, .followers = {[&](const Model&, TouchBackend&) {
                                                                  return std::make_unique<AttributeFollower>(followed);
                                                                }}}};

  const LayerAttributes& attributes() const { return session.scene().layers[0].attributes; }
  PointSet existingOf(MaskRole role) const { return existing(attributes().mask(role), session.history()->points()); }
  bool isFollowed(MaskRole role) const { return followed.mask(role) == attributes().mask(role); }
  void stroke() {
    runAlone(session, strokeFrom({0, 0, 1}, 8, 1.0));
    session.finish();
  }
};

PointSet upperHalf(const PointCloud& cloud) {
  PointSet upper;
  for (std::size_t i = 0; i < cloud.size(); ++i) upper.set(i, cloud.positions[i].z > 0);
  return upper;
}

std::vector<std::byte> bytesOf(std::span<const float> values) {
  const auto bytes = std::as_bytes(values);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

TEST_CASE("a mask of a session is undone and redone in order with strokes, whose new points have it, and is followed") {
  FollowedSession made;
  Session& session = made.session;
  const PointSet upper = upperHalf(session.model().cloud);
  session.setMask(MaskRole::selected, upper);
  session.setMask(MaskRole::selected, upper);  // changes nothing
  CHECK(session.strokes().undoCount == 1);
  CHECK(session.strokes().version == 0);
  CHECK(made.isFollowed(MaskRole::selected));
  made.stroke();
  const PointStates& points = session.history()->points();
  const std::size_t before = session.model().cloud.size();
  REQUIRE(points.size() > before + 10);  // the stroke has inserted some
  for (std::uint64_t point = before; point < points.size(); ++point)
    CHECK(made.attributes().mask(MaskRole::selected).test(point));
  CHECK(made.isFollowed(MaskRole::selected));
  const PointSet stroked = made.existingOf(MaskRole::selected);
  session.setMask(MaskRole::selected, {});
  CHECK(made.existingOf(MaskRole::selected).empty());

  CHECK(session.undo(1, 0).undone == 1);
  CHECK(made.existingOf(MaskRole::selected) == stroked);
  CHECK(session.undo(1, 0).undone == 1);
  CHECK(made.existingOf(MaskRole::selected) == upper);
  CHECK(session.undo(9, 0).undone == 1);
  CHECK(made.existingOf(MaskRole::selected).empty());
  CHECK(made.isFollowed(MaskRole::selected));
  CHECK(session.undo(0, 2).redone == 2);
  CHECK(made.existingOf(MaskRole::selected) == stroked);
  CHECK(session.undo(0, 2).redone == 1);
  CHECK(made.existingOf(MaskRole::selected).empty());
  CHECK(made.isFollowed(MaskRole::selected));
}

TEST_CASE("a field of a session is set, undone, and written with the points") {
  FollowedSession made;
  Session& session = made.session;
  const std::uint32_t field = session.fieldNamed("temperature");
  CHECK(session.fieldNamed("temperature") == field);
  CHECK(session.strokes().undoCount == 1);
  const std::uint64_t withField = session.strokes().version;
  CHECK(withField != 0);
  const std::vector<float> warm(50, 300);
  session.setField(field, PointSet::range(100, 150), bytesOf(warm));
  CHECK(session.strokes().version != withField);
  const auto written = [&] {
    const PointCloud cloud = session.sculpted().cloud;
    REQUIRE(cloud.extra.size() == 1);
    CHECK(cloud.extra[0].name == "temperature");
    REQUIRE(cloud.extra[0].data.size() == cloud.size() * sizeof(float));
    std::vector<float> values(cloud.size());
    std::memcpy(values.data(), cloud.extra[0].data.data(), cloud.extra[0].data.size());
    return values;
  };
  CHECK(std::ranges::count(written(), 300.0f) == 50);
  CHECK(written()[149] == 300);
  session.undo(1, 0);
  CHECK(std::ranges::count(written(), 0.0f) == static_cast<std::ptrdiff_t>(session.model().cloud.size()));
  CHECK(session.strokes().version == withField);
  session.undo(1, 0);
  CHECK(made.attributes().fields().empty());
  CHECK(session.sculpted().cloud.extra.empty());
  CHECK(session.strokes().version == 0);
  session.undo(0, 2);
  CHECK(std::ranges::count(written(), 300.0f) == 50);

  const auto refused = [&](std::uint32_t number, std::uint64_t first, std::size_t values) {
    return errorOf<Error>(
        [&] { session.setField(number, PointSet::range(first, first + 50), bytesOf(std::vector<float>(values))); });
  };
  CHECK(refused(1, 100, 50) == "field: the model has 1 fields, and none with number 1");
  CHECK(refused(field, 4000, 50) == "temperature: the model has no point 4049");
  CHECK(refused(field, 100, 49) == "temperature: 50 points require 200 bytes, not 196");
  CHECK(session.strokes().undoCount == 2);
}

TEST_CASE("values of a field that is missing are one change, which undo takes back with the field") {
  FollowedSession made;
  Session& session = made.session;
  const auto ones = [](std::size_t count) { return std::vector<std::byte>(count, std::byte{1}); };
  session.setField("chosen", ScalarType::u8, PointSet::range(100, 150), ones(50));
  CHECK(session.strokes().undoCount == 1);
  const auto count = [&] { return std::ranges::count(session.sculpted().cloud.extra.at(0).data, std::byte{1}); };
  CHECK(count() == 50);
  CHECK(session.sculpted().cloud.extra[0].data[149] == std::byte{1});
  session.setField("chosen", ScalarType::u8, PointSet::range(0, 10), ones(10));
  CHECK(session.strokes().undoCount == 2);
  CHECK(count() == 60);
  session.undo(1, 0);
  CHECK(count() == 50);
  session.undo(1, 0);
  CHECK(made.attributes().fields().empty());
  session.undo(0, 1);
  CHECK(count() == 50);
  const auto refused = [&](const char* name, ScalarType type, std::uint64_t first, std::size_t values) {
    return errorOf<Error>([&] { session.setField(name, type, PointSet::range(first, first + 2), ones(values)); });
  };
  CHECK(refused("chosen", ScalarType::u16, 0, 4) == "chosen: its values are uchar, not ushort");
  CHECK(refused("other", ScalarType::u8, 0, 1) == "other: 1 values for 2 points, the last of which is 1");
  CHECK(refused("other", ScalarType::u8, 90'000, 2) == "other: 2 values for 2 points, the last of which is 90001");
  CHECK(made.attributes().fields().size() == 1);
}

TEST_CASE("masks and fields are refused as the table says, and by a session that does not follow its points") {
  const auto cpu = cpuBackend();
  SessionConfig moved{.backend = {.name = "cpu"}, .hands = std::vector<HandConfig>(1)};
  moved.motion = MotionConfig{};
  Session moving(moved, sphereModel(2000), {.backend = *cpu, .keepsPoints = true});
  const Abilities can(ModelKind::moved);
  CHECK(errorOf<Error>([&] { moving.setMask(MaskRole::hidden, {}); }) == "select: " + can.refusal(Action::select));
  CHECK(errorOf<Error>([&] { moving.fieldNamed("heat"); }) == "heat: " + can.refusal(Action::field));
  Session deaf({.backend = {.name = "cpu"}, .hands = std::vector<HandConfig>(1)}, sphereModel(2000), {.backend = *cpu});
  CHECK(errorOf<Error>([&] { deaf.setMask(MaskRole::hidden, {}); }) ==
        "select: the session does not follow its points");
}

TEST_CASE("a placement turns a position, then moves it") {
  const Placement placement{.rotation = glm::angleAxis(std::numbers::pi / 2, DVec3(0, 0, 1)), .offset = {10, 0, 0}};
  CHECK(glm::distance(placement({1, 0, 0}), DVec3(10, 1, 0)) < 1e-12);
  CHECK(Placement()({1, 2, 3}) == DVec3(1, 2, 3));
}

}  // namespace palpate::scene_test
