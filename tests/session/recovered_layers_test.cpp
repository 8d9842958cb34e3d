// Layers of strokes of a session that was cut off are recovered with their strokes, and so is what was undone.
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/io/cloud_formats.hpp"
#include "tests/session/attributed_person.hpp"

namespace palpate::recovered_layers_test {

using kept_attributes_test::attributesOf;
using kept_attributes_test::Person;

namespace {

void setLayer(Person& person, std::uint32_t number, double strength, bool isOpen, bool continues = false) {
  person.session.setStrokeLayer(number, {.name = "layer " + std::to_string(number), .strength = strength}, isOpen,
                                continues);
}

std::vector<PointState> existing(const Person& person) {
  std::vector<PointState> states;
  for (const PointState& state : person.session.history().points())
    if (!state.gone) states.push_back(state);
  return states;
}

// Where the fixture's own stroke does not go.
void strokeFromSide(Person& person) {
  const std::uint64_t before = person.session.session().strokes().strokes;
  for (const double x : {55.0, 46.0}) {
    person.session.aim({x, 0, 0});
    person.goOn(0.3);
  }
  person.session.lift();
  person.goOn(0.5);
  REQUIRE(person.session.session().strokes().strokes > before);
}

const StrokeLayers& layersOf(const Person& person) { return attributesOf(person.session.session()).strokeLayers(); }

std::shared_ptr<const LeftStrokes> leftIn(const ScratchFolder& folder) {
  std::vector<LeftStrokes> found = leftStrokes(folder / "unsaved", [](const std::string& what) { FAIL_CHECK(what); });
  REQUIRE(found.size() == 1);
  return std::make_shared<const LeftStrokes>(std::move(found[0]));
}

}  // namespace

TEST_CASE("layers, their strokes and slides that were not saved are recovered, and slide and undo as before") {
  const ScratchFolder folder;
  const InteractiveOptions kept{.unsavedIn = folder / "unsaved"};
  writeCloud(folder / "sphere.ply", sphereModel().cloud);
  std::vector<PointState> plain, made, slid;
  std::size_t undoCount = 0;
  {
    Person person(folder, kept);
    plain = existing(person);
    setLayer(person, 0, 1, true);
    person.stroke();
    made = existing(person);
    setLayer(person, 0, 0.8, false);
    setLayer(person, 0, 0.3, false, true);
    CHECK(person.session.undo());
    CHECK(person.session.redo());
    setLayer(person, 0, 1.5, false);
    CHECK(person.session.undo());
    slid = existing(person);
    undoCount = person.undoCount();
    person.goOn(0.3);
  }
  Person again(folder, {.left = leftIn(folder)});
  CHECK(existing(again) == slid);
  CHECK(again.undoCount() == undoCount);
  REQUIRE(layersOf(again).size() == 1);
  CHECK(layersOf(again)[0].strength == 0.3);
  CHECK_FALSE(layersOf(again).open());
  setLayer(again, 0, 0, false);
  CHECK(existing(again) == plain);
  setLayer(again, 0, 1, false);
  CHECK(existing(again) == made);
  CHECK(again.session.undo());
  CHECK(again.session.undo());
  CHECK(existing(again) == slid);
  CHECK(again.session.undo());
  CHECK(existing(again) == made);
  CHECK(again.session.undo());
  CHECK(existing(again) == plain);
  CHECK(layersOf(again).pointsOf(0) == 0);
  CHECK(again.session.undo());
  CHECK(layersOf(again).size() == 0);
}

TEST_CASE(
    "a layer slides as before when its strokes were saved, and some then undone, before the session was cut off") {
  for (const int undone : {0, 1, 2}) {
    CAPTURE(undone);
    const ScratchFolder folder;
    const InteractiveOptions kept{.unsavedIn = folder / "unsaved"};
    writeCloud(folder / "sphere.ply", sphereModel().cloud);
    std::vector<PointState> plain, last;
    {
      Person person(folder, kept);
      plain = existing(person);
      setLayer(person, 0, 1, true);
      person.stroke();
      strokeFromSide(person);
      setLayer(person, 0, 0.5, false);
      person.goOn(0.3);
      CHECK(person.save(person.file).failure == "");
      for (int i = 0; i < undone; ++i) CHECK(person.session.undo());
      if (undone == 0) setLayer(person, 0, 0.7, false);
      last = existing(person);
      person.goOn(0.3);
    }
    Person again(folder, {.left = leftIn(folder)});
    CHECK(existing(again) == last);
    REQUIRE(layersOf(again).size() == 1);
    CHECK(layersOf(again)[0].strength == (undone == 0 ? 0.7 : 1.0));
    setLayer(again, 0, 0, false);
    CHECK(existing(again) == plain);
  }
}

TEST_CASE("a layer slides on when the session continues with its points, as after another device was chosen") {
  const ScratchFolder folder;
  writeCloud(folder / "sphere.ply", sphereModel().cloud);
  Person person(folder);
  setLayer(person, 0, 1, true);
  person.stroke();
  setLayer(person, 0, 0, false);
  setLayer(person, 0, 0.3, false);
  InteractiveSession::HandedOn handed = person.session.handOn();
  const std::vector<PointState> slid = existing(person);
  Person next(folder, {.attributes = handed.attributes}, std::move(handed.model));
  REQUIRE(layersOf(next).size() == 1);
  CHECK(layersOf(next)[0].strength == 0.3);
  CHECK(layersOf(next).pointsOf(0) > 5);
  setLayer(next, 0, 0, false);
  double most = 0;
  std::size_t at = 0;
  const auto before = sphereModel().cloud.positions;
  for (const PointState& state : next.session.history().points()) {
    const std::uint64_t number = slid[at++].number;
    if (number < before.size()) most = std::max(most, glm::distance(DVec3(state.position), DVec3(before[number])));
  }
  CHECK(at == slid.size());
  CHECK(most < 1e-5);
}

}  // namespace palpate::recovered_layers_test
