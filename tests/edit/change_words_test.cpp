// What an entry of the history is, in words, for each kind of entry.
#include "engine/edit/change_words.hpp"

#include <doctest/doctest.h>

#include <functional>

namespace palpate::change_words_test {

namespace {

PointCloud fivePoints() {
  PointCloud cloud;
  for (int i = 0; i < 5; ++i) cloud.positions.emplace_back(i, 0, 0), cloud.normals.emplace_back(0, 0, 1);
  return cloud;
}

struct Scene {
  PointStates present{fivePoints()};
  LayerAttributes attributes;

  std::string words(HistoryChange change) const {
    const auto& [what, points] = inWords(change, present, attributes);
    return what + "; " + points;
  }
  // Of a change of so many points; `alter` makes their states on the other side.
  std::string ofStroke(std::size_t count, const std::function<void(PointState&)>& alter,
                       PointStroke stroke = {}) const {
    for (std::size_t i = 0; i < count; ++i) alter(stroke.points.emplace_back(present[i]));
    return words({stroke});
  }
  // Once it is made.
  std::string made(AttributeChange change) {
    attributes.exchange(change);
    return words({change});
  }
};

}  // namespace

TEST_CASE("each kind of an entry of the history has a name, and the number of its points") {
  Scene scene;
  const auto moved = [](PointState& state) { state.position.z = 1; };
  CHECK(scene.ofStroke(3, moved) == "stroke; 3 points");
  CHECK(scene.ofStroke(1, moved, {.isGiven = true}) == "move; 1 point");
  CHECK(scene.ofStroke(2, [](PointState& state) { state.color = 7; }) == "paint; 2 points");
  CHECK(scene.ofStroke(4, [](PointState& state) { state.normal.x = 1; }) == "normals; 4 points");
  CHECK(scene.ofStroke(2, [](PointState& state) { state.gone = true; }) == "new points; 2 points");
  CHECK(scene.words({PresenceStroke{.points = PointSet::range(0, 2)}}) == "restored points; 2 points");
  scene.present.flip(PointSet::range(0, 2));
  CHECK(scene.words({PresenceStroke{.points = PointSet::range(0, 2)}}) == "removal; 2 points");
  CHECK(scene.words({ShapeStroke{.places = std::vector<RestPlace>(6)}}) == "stroke; 6 points");
  const auto flip = [&](MaskRole role) { return scene.made(MaskFlip{.role = role, .points = PointSet::range(1, 4)}); };
  CHECK(flip(MaskRole::selected) == "selection; 3 points");
  CHECK(flip(MaskRole::hidden) == "hiding; 3 points");
  CHECK(flip(MaskRole::locked) == "lock; 3 points");
  CHECK(flip(MaskRole::within) == "limit of the brushes; 3 points");
  const auto field = [&](std::string_view name) {
    return initialField(fivePoints(), scene.present, name, ScalarType::u8, scene.attributes.fields().size());
  };
  CHECK(scene.made(field("class")) == "new field class; ");
  CHECK(scene.made(FieldChange{.field = 0, .points = PointSet::range(0, 1), .values = {std::byte{1}}}) ==
        "values of class; 1 point");
  CHECK(scene.made(field(kLockField)) == "lock with a soft rim; ");
  CHECK(scene.made(FieldChange{.field = 1, .points = PointSet::range(0, 1), .values = {std::byte{1}}}) ==
        "lock; 1 point");
  CHECK(scene.made(StrokeLayerChange{.set = {.name = "nose"}}) == "new layer nose; ");
  CHECK(scene.made(StrokeLayerChange{.set = {.name = "nose"}, .open = 0}) == "opening nose; ");
  CHECK(scene.made(StrokeLayerChange{.set = {.name = "nose"}}) == "closing nose; ");
  CHECK(scene.ofStroke(3, moved, {.layer = 0}) == "stroke in nose; 3 points");
  CHECK(scene.ofStroke(3, moved, {.slide = StrokeLayerChange{}}) == "strength of nose; 3 points");
  CHECK(scene.made(StrokeLayerChange{.set = {.name = "nose", .isMerged = true}}) == "merging nose; ");
}

}  // namespace palpate::change_words_test
