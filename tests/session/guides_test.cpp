// Guides beside a model in a picture.
#include "haptics/session/guides.hpp"

#include <doctest/doctest.h>

#include "engine/core/error.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"

namespace palpate::guides_test {

namespace {

/// A box from 0.3 to 12.7 along x, 0 to 5 along y and -2 to 2 along z in the file, whose origin is far off.
Model boxModel() {
  Model model;
  model.cloud.origin = {4e6, 0, -100};
  for (const Vec3& corner : {Vec3(0.3F, 0, 98), Vec3(12.7F, 5, 102)}) model.cloud.positions.push_back(corner);
  return model;
}

std::vector<std::string> textsOf(const Guides& guides) {
  std::vector<std::string> texts;
  for (const SpaceLabel& label : guides.labels) texts.push_back(label.text);
  return texts;
}

}  // namespace

TEST_CASE("guides are named in a list, and a wrong name is refused with all right ones") {
  CHECK_FALSE(guidesNamed("", "--guides").any());
  const GuideConfig two = guidesNamed("grid,box", "--guides");
  CHECK(two == GuideConfig{.box = true, .grid = true});
  CHECK(errorOf([] { guidesNamed("box,plinth", "--guides"); }) ==
        "--guides: 'plinth' is none of box, axes, grid and compass, separated by commas");
  CHECK_THROWS_AS(guidesNamed("box,,grid", "--guides"), UsageError);
}

TEST_CASE("a box has twelve edges, and its lengths in the unit of the file") {
  const Guides guides = guidesOf(boxModel(), UpAxis::z, LengthUnit::m, {.box = true});
  CHECK(guides.lines.size() == 12);
  CHECK(textsOf(guides) == std::vector<std::string>{"12.4 m", "5 m", "4 m"});
  double edges = 0;
  for (const SpaceLine& line : guides.lines) edges += glm::distance(line.from, line.to);
  CHECK(edges == near(4 * (12.4 + 5 + 4), 1e-6));
}

TEST_CASE("axes have the coordinates of the file, at round numbers within the box") {
  const Guides guides = guidesOf(boxModel(), UpAxis::z, LengthUnit::unknown, {.axes = true});
  const std::vector<std::string> texts = textsOf(guides);
  CHECK(texts == std::vector<std::string>{"4000002", "4000004", "4000006", "4000008", "4000010", "4000012", "0", "2",
                                          "4", "-2", "0", "2"});
  // The tick of 4000004 is at 4 in the cloud's coordinates.
  CHECK(guides.lines[2].from.x == near(4, 1e-9));
}

TEST_CASE("a grid lies below the model along its up axis, and its lines are at multiples of its step") {
  for (const auto& [up, ground] : {std::pair(UpAxis::z, 98.0), {UpAxis::minusZ, 102.0}}) {
    const Guides guides = guidesOf(boxModel(), up, LengthUnit::m, {.grid = true});
    CHECK(textsOf(guides) == std::vector<std::string>{"squares of 1 m"});
    REQUIRE(guides.lines.size() > 10);
    for (const SpaceLine& line : guides.lines) {
      CHECK(line.from.z == near(ground, 1e-9));
      CHECK(line.to.z == line.from.z);
      CHECK(std::abs(line.from.x - std::round(line.from.x)) < 1e-6);  // the file's are whole, and so is the origin
      CHECK(std::abs(line.from.y - std::round(line.from.y)) < 1e-6);
    }
  }
}

TEST_CASE("a compass is in the corner of the picture, whatever the camera looks at, and its axes are the model's") {
  for (const double height : {0.0, 3.0}) {
    Camera camera{.eye = {20, 5, 100}, .target = {6, 2, 100}, .height = height};
    camera.setDepthRange({{0, 0, 98}, {13, 5, 102}}, 13);
    const UVec2 size_px(800, 600);
    const Guides guides = compassOf(camera, size_px);
    REQUIRE(guides.lines.size() == 3);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const DVec3 way = guides.lines[axis].to - guides.lines[axis].from;
      CHECK(way[static_cast<int>(axis)] == near(glm::length(way), 1e-9));
      for (const DVec3& end : {guides.lines[axis].from, guides.lines[axis].to}) {
        const auto at = camera.project(end, DVec2(size_px));
        REQUIRE(at);
        CHECK(at->x < 130);
        CHECK(at->y < 120);
      }
    }
    const PictureGuides all({.box = true, .compass = true}, boxModel(), UpAxis::z, LengthUnit::m);
    CHECK(all.linesWith({SpaceLine()}, camera, size_px)->size() == 1 + 12 + 3);
    std::size_t letters = 0;
    for (const PictureLabel& label : all.labelsIn(camera, size_px)) letters += label.text.size() == 1;
    CHECK(letters == 3);
  }

  const PictureGuides none;
  CHECK(none.linesWith({}, Camera(), UVec2(9)) == nullptr);
}

TEST_CASE("labels cover neither each other nor what has its room, but for the letters of the compass") {
  LabelRoom room;
  room.reserve({80, 40}, {100, 90});  // a legend
  const PictureLabel length{{20, 20}, "5 m"}, letter{{20, 20}, "x", true};
  CHECK(room.admits(length, {10, 10}, {30, 20}));
  CHECK_FALSE(room.admits(length, {29, 19}, {50, 30}));  // on the first one
  CHECK(room.admits(length, {30, 10}, {50, 20}));        // beside it
  CHECK_FALSE(room.admits(length, {70, 80}, {81, 95}));  // on the legend
  CHECK_FALSE(room.admits(length, {85, 50}, {90, 60}));  // within it
  CHECK_FALSE(room.admits(length, {70, 30}, {110, 99}));
  CHECK(room.admits(length, {70, 30}, {80, 99}));
  CHECK(room.admits(letter, {12, 12}, {18, 18}));
  CHECK_FALSE(room.admits(length, {0, 12}, {13, 14}));

  // The compass has its room before the lengths.
  const PictureGuides all({.box = true, .compass = true}, boxModel(), UpAxis::z, LengthUnit::m);
  Camera camera{.eye = {20, 5, 100}, .target = {6, 2, 100}};
  camera.setDepthRange({{0, 0, 98}, {13, 5, 102}}, 13);
  const std::vector<PictureLabel> labels = all.labelsIn(camera, {800, 600});
  REQUIRE(labels.size() > 3);
  for (std::size_t k = 0; k < labels.size(); ++k) CHECK(labels[k].always == (k < 3));
}

TEST_CASE("guides of a model of one point, or of none, are empty but for the compass") {
  Model one;
  one.cloud.positions.push_back(Vec3(1, 2, 3));
  for (const Model& model : {one, Model()}) {
    const Guides guides = guidesOf(model, UpAxis::y, LengthUnit::m, {true, true, true, true});
    CHECK(guides.lines.empty());
    CHECK(guides.labels.empty());
  }
}

}  // namespace palpate::guides_test
