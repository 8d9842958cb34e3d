// Points that a command removes or paints are one stroke: undone to the last bit, recorded, replayed and recovered.
#include <doctest/doctest.h>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/io/cloud_formats.hpp"
#include "haptics/session/session_replay.hpp"
#include "tests/content_of.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/attributed_person.hpp"

namespace palpate::selected_points_test {

using kept_attributes_test::Person;

namespace {

std::vector<PointState> statesOf(const Person& person) {
  const PointStates& points = person.session.history().points();
  return {points.begin(), points.end()};
}

// Points that a stroke has inserted stay as numbers when it is undone.
bool areSameToTheBit(std::vector<PointState> a, const std::vector<PointState>& b) {
  const auto hasNone = [](const PointState& point) { return point.gone; };
  if (a.size() < b.size() || !std::all_of(a.begin() + static_cast<std::ptrdiff_t>(b.size()), a.end(), hasNone))
    return false;
  a.resize(b.size());
  return std::ranges::equal(a, b, [](const PointState& x, const PointState& y) { return isSameToTheBit(x, y); });
}

// Most of them are below the middle, where no stroke goes.
PointSet some() {
  PointSet points = PointSet::range(2500, 3300);
  points.set(30);
  points.set(3999);
  return points;
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

}  // namespace

TEST_CASE("removed points are one stroke: exactly they are gone, and one undo restores all to the last bit") {
  const ScratchFolder folder;
  Person person(folder);
  person.stroke();
  const std::vector<PointState> before = statesOf(person);
  const StrokeCounts counts = person.session.session().strokes();
  REQUIRE(person.save((folder / "before.ply").string()).failure == "");
  person.session.changePoints(some(), RemovePoints());
  CHECK(person.session.session().strokes().strokes == counts.strokes + 1);
  // Followers count the changes of a back end, whose mark stays, without states of its own.
  const std::uint64_t count = person.session.session().lastEdits().points.size();
  CHECK(count == some().count());
  CHECK(person.session.session().lastEdits().marks ==
        std::vector<EditMark>{{count, EditMark::Kind::stroke}, {count, EditMark::Kind::change}});
  CHECK(person.session.isChanged());
  const std::vector<PointState> after = statesOf(person);
  REQUIRE(after.size() == before.size());
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    PointState expected = before[i];
    expected.gone |= some().test(i);
    wrong += !isSameToTheBit(after[i], expected);
  }
  CHECK(wrong == 0);
  // The back end has what the history has.
  person.goOn(0.1);
  CHECK(person.session.session().backend().edits()->progress().dropped == 0);
  REQUIRE(person.save((folder / "after.ply").string()).failure == "");
  CHECK(readCloud(folder / "after.ply").cloud.size() == person.session.history().points().present());
  CHECK(person.session.undo());
  CHECK(areSameToTheBit(statesOf(person), before));
  CHECK(person.session.session().strokes().undoCount == counts.undoCount);
  REQUIRE(person.save((folder / "undone.ply").string()).failure == "");
  CHECK(contentOf(folder / "undone.ply") == contentOf(folder / "before.ply"));
  CHECK(person.session.redo());
  CHECK(areSameToTheBit(statesOf(person), after));
}

TEST_CASE("painted points change nothing but their colour, and what does not exist stays") {
  const ScratchFolder folder;
  Person person(folder);
  person.session.changePoints(PointSet::range(0, 50), RemovePoints());
  const std::vector<PointState> before = statesOf(person);
  const std::uint32_t red = packedColor({255, 0, 0, 255});
  person.session.changePoints(some(), PaintPoints{red});
  const std::vector<PointState> after = statesOf(person);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    PointState expected = before[i];
    if (some().test(i) && i >= 50) expected.color = red;
    wrong += !isSameToTheBit(after[i], expected);
  }
  CHECK(wrong == 0);
  const std::size_t depth = person.undoCount();
  person.session.changePoints(some(), PaintPoints{red});                     // they have that colour
  person.session.changePoints(PointSet::range(0, 50), RemovePoints());       // they are gone
  person.session.changePoints({}, RemovePoints());                           // none
  person.session.changePoints(PointSet::range(9000, 9001), RemovePoints());  // there is no such point
  CHECK(person.undoCount() == depth);
  CHECK(person.session.undo());
  CHECK(areSameToTheBit(statesOf(person), before));
}

TEST_CASE("moved points rotate, scale and shift by the numbers, nothing else moves, and one undo restores them") {
  const ScratchFolder folder;
  Person person(folder);
  const std::vector<PointState> before = statesOf(person);
  const DVec3 centre(1, -2, 3), way(0.5, 0, -0.25);
  // A quarter about z, twice as large: exact numbers.
  const DQuat quarter(std::sqrt(0.5), 0, 0, std::sqrt(0.5));
  person.session.changePoints(some(), MovePoints::about(centre, quarter, 2, way));
  const std::vector<PointState> after = statesOf(person);
  REQUIRE(after.size() == before.size());
  std::size_t moved = 0, wrong = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (!some().test(i)) {
      wrong += !isSameToTheBit(after[i], before[i]);
      continue;
    }
    const DVec3 arm = DVec3(before[i].position) - centre;
    const DVec3 expected = centre + way + 2.0 * DVec3(-arm.y, arm.x, arm.z);
    const Vec3 n = before[i].normal;
    wrong += glm::distance(DVec3(after[i].position), expected) > 1e-5;
    wrong += glm::distance(after[i].normal, Vec3(-n.y, n.x, n.z)) > 1e-6F;
    wrong += after[i].color != before[i].color || after[i].parent != before[i].parent || after[i].gone;
    ++moved;
  }
  CHECK(wrong == 0);
  CHECK(moved == some().count());
  // The hand feels them at their new position.
  person.goOn(0.1);
  CHECK(person.session.session().backend().edits()->progress().dropped == 0);
  const std::size_t depth = person.undoCount();
  person.session.changePoints(some(), MovePoints());
  CHECK(person.undoCount() == depth);  // nothing has moved
  const auto refused = [&](const MovePoints& move) {
    return errorOf([&] { person.session.changePoints(some(), move); });
  };
  CHECK(says(refused({.scale = 0}), "positive"));
  CHECK(says(refused({.scale = NAN}), "finite"));
  CHECK(says(refused({.rotation = {0.5, 0, 0, 0}}), "unit"));
  CHECK(says(refused({.offset = {1e200, 0, 0}}), "infinitely"));
  CHECK(areSameToTheBit(statesOf(person), after));
  CHECK(person.session.undo());
  CHECK(areSameToTheBit(statesOf(person), before));
}

TEST_CASE("a removal takes back what was undone, and is undone in order with strokes and masks") {
  const ScratchFolder folder;
  Person person(folder);
  std::vector<std::vector<PointState>> states{statesOf(person)};
  person.stroke();
  states.push_back(statesOf(person));
  person.session.changePoints(some(), RemovePoints());
  states.push_back(statesOf(person));
  person.session.setMask(MaskRole::selected, some());
  strokeFromSide(person);
  states.push_back(statesOf(person));
  REQUIRE(person.undoCount() == 4);
  CHECK(person.session.undo());
  CHECK(areSameToTheBit(statesOf(person), states[2]));
  CHECK(person.session.undo());
  CHECK(person.session.attributes().mask(MaskRole::selected).empty());
  CHECK(person.session.undo());
  CHECK(areSameToTheBit(statesOf(person), states[1]));
  person.session.changePoints(PointSet::range(0, 3), RemovePoints());
  CHECK_FALSE(person.session.redo());
  CHECK(person.session.undo());
  CHECK(person.session.undo());
  CHECK(areSameToTheBit(statesOf(person), states[0]));
  CHECK_FALSE(person.session.isChanged());
}

TEST_CASE("points that are removed elsewhere leave a hand's force as it is") {
  const ScratchFolder folder;
  Person person(folder);
  person.session.setBrush(std::nullopt);
  person.session.aim({0, 0, 55});
  person.goOn(0.2);
  person.session.aim({0, 0, 48});
  person.goOn(0.5);
  const auto force_N = [&] { return glm::length(person.session.recentTicks().rows().back().force_N); };
  const double before_N = force_N();
  REQUIRE(before_N > 0.2);
  PointSet below;
  for (const PointState& point : statesOf(person))
    if (point.position.z < -10) below.set(point.number);
  REQUIRE(below.count() > 1000);
  person.session.changePoints(below, RemovePoints());
  for (int i = 0; i < 20; ++i) {
    person.goOn(0.001);
    CHECK(force_N() == near(before_N, 0.05));
  }
  CHECK(person.session.history().points().present() == 4000 - below.count());
}

namespace {

// New points over the top of the sphere, and another normal of one of the file.
SetPoints newPoints(const Person& person) {
  const std::vector<PointState> states = statesOf(person);
  SetPoints set{{states[40]}};
  set.states[0].normal = -set.states[0].normal;
  for (std::uint64_t k = 0; k < 20; ++k)
    set.states.push_back({.position = Vec3(0.1f * static_cast<float>(k), 0, 51),
                          .number = states.size() + k,
                          .normal = Vec3(0, 0, 1),
                          .color = states[7].color,
                          .parent = 7 + k});
  return set;
}

}  // namespace

TEST_CASE("new points and other normals are one stroke: felt, saved, masked as their parents, and undone exactly") {
  const ScratchFolder folder;
  Person person(folder);
  person.session.setBrush(std::nullopt);
  person.session.setMask(MaskRole::selected, PointSet::range(7, 10));
  const std::vector<PointState> before = statesOf(person);
  const SetPoints set = newPoints(person);
  person.session.changePoints({}, set);
  CHECK(person.undoCount() == 2);
  const std::vector<PointState> after = statesOf(person);
  REQUIRE(after.size() == before.size() + 20);
  for (const PointState& state : set.states) CHECK(isSameToTheBit(after[state.number], state));
  CHECK(person.session.attributes().mask(MaskRole::selected).count() == 6);
  REQUIRE(person.save((folder / "more.ply").string()).failure == "");
  const PointCloud saved = readCloud(folder / "more.ply").cloud;
  REQUIRE(saved.size() == after.size());
  CHECK(saved.normals[40] == set.states[0].normal);
  CHECK(saved.positions.back() == set.states.back().position);
  CHECK(person.session.undo());
  CHECK(areSameToTheBit(statesOf(person), before));
  CHECK(person.session.redo());
  CHECK(areSameToTheBit(statesOf(person), after));
  // Those that are undone keep their numbers.
  CHECK(person.session.undo());
  const SetPoints again = newPoints(person);
  CHECK(again.states[1].number == before.size() + 20);
  person.session.changePoints({}, again);
  CHECK(statesOf(person).size() == before.size() + 40);
  // Numbers that do not follow, and parents that do not exist.
  const auto refused = [&](std::uint64_t number, std::uint64_t parent) {
    const PointState state{.number = number, .normal = Vec3(0, 0, 1), .parent = parent};
    return errorOf([&] { person.session.changePoints({}, SetPoints{{state}}); });
  };
  const std::size_t count = statesOf(person).size();
  CHECK(refused(count + 1, 0) == fmt::format("set: the model has {0} points, and no point {1}", count, count + 1));
  CHECK(refused(count, count) == fmt::format("set: the model has {0} points, and no point {0}", count));
  CHECK(statesOf(person).size() == count);
}

TEST_CASE("an action survives a log to the bit, and bytes that are none are refused") {
  const SetPoints set{{{.position = {1, 2, 3}, .number = 5, .normal = {0, 0, 1}, .color = 9, .parent = 4},
                       {.position = {4, 5, 6}, .gone = true, .number = 6, .normal = {1, 0, 0}, .parent = 2}}};
  const std::string bytes = bytesIn(set, {});
  const auto read = readPointsAction(bytes);
  REQUIRE(read.has_value());
  const auto& states = std::get<SetPoints>(read->first).states;
  REQUIRE(states.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) CHECK(isSameToTheBit(states[i], set.states[i]));
  CHECK(read->second.empty());
  CHECK_FALSE(readPointsAction(std::string_view(bytes).substr(0, 40)).has_value());
  std::string wrong = bytes;
  wrong[0] = 9;
  CHECK_FALSE(readPointsAction(wrong).has_value());
  wrong = bytes;
  wrong[15] = '\x7f';  // of the count
  CHECK_FALSE(readPointsAction(wrong).has_value());
}

TEST_CASE("a replay repeats removed and painted points among strokes, and their undo, bit by bit") {
  const ScratchFolder folder;
  const std::string log = (folder / "session.log").string();
  std::vector<PointState> end;
  {
    Person person(folder);
    person.session.aim({0, 0, 55});
    person.goOn(0.3);
    person.session.record(log);
    person.stroke();
    person.session.changePoints(some(), RemovePoints());
    person.goOn(0.05);
    person.session.changePoints(PointSet::range(1000, 1100), PaintPoints{packedColor({1, 2, 3, 255})});
    strokeFromSide(person);
    person.session.changePoints(PointSet::range(1500, 1600), RemovePoints());
    person.session.changePoints({}, newPoints(person));
    person.session.changePoints(PointSet::range(1200, 1300), MovePoints{.scale = 1.01, .offset = {0, 0, 0.5}});
    person.goOn(0.05);
    CHECK(person.session.undo());
    person.goOn(0.05);
    person.session.endRecording();
    end = statesOf(person);
  }
  std::vector<std::unique_ptr<BackendKind>> kinds;
  kinds.push_back(cpuBackend());
  const Backends backends(std::move(kinds));
  Log silent(true);
  const PointCloud cloud = sphereModel().cloud;
  const ReplayParts parts{.backends = backends, .log = silent, .threads = 1, .cloud = &cloud};
  Recorded recorded = loadRecorded(log, parts);
  CHECK(areSameToTheBit(recorded.points, end));
  CHECK(recorded.endsAsRecorded == true);
  const SessionAgain again = runAgain(recorded, parts);
  CHECK(areSameToTheBit(again.points, end));
  const ReplayOutcome outcome = compareRuns(recorded, again, 0);
  CAPTURE(outcome.comparable.because);
  CHECK(outcome.isWhole(recorded));
}

TEST_CASE("a removal that was not saved is recovered, and can be undone") {
  const ScratchFolder folder;
  writeCloud(folder / "sphere.ply", sphereModel().cloud, {});
  std::vector<PointState> stroked, removed;
  {
    Person person(folder, {.unsavedIn = folder / "unsaved"});
    person.stroke();
    stroked = statesOf(person);
    person.session.changePoints(some(), RemovePoints());
    person.session.changePoints({}, newPoints(person));
    removed = statesOf(person);
    person.goOn(0.2);
  }
  std::vector<LeftStrokes> left = leftStrokes(folder / "unsaved", [](const std::string&) {});
  REQUIRE(left.size() == 1);
  CHECK(left[0].since.made == 3);
  Person next(folder,
              {.unsavedIn = folder / "unsaved", .left = std::make_shared<const LeftStrokes>(std::move(left[0]))});
  CHECK(areSameToTheBit(statesOf(next), removed));
  CHECK(next.session.isChanged());
  CHECK(next.undoCount() == 3);
  CHECK(next.session.undo());
  CHECK(next.session.undo());
  CHECK(areSameToTheBit(statesOf(next), stroked));
  CHECK(next.session.undo());
}

TEST_CASE("a model that does not keep its points refuses to remove or paint some") {
  const ScratchFolder folder;
  SessionConfig config = kept_attributes_test::carving((folder / "sphere.ply").string());
  config.brush.reset();
  config.motion = MotionConfig{};
  const auto cpu = cpuBackend();
  Session session(config, sphereModel(), {.backend = *cpu, .threads = 1, .keepsPoints = true});
  CHECK(says(errorOf([&] { session.changePoints(some(), RemovePoints()); }), "a moving model cannot be sculpted"));
  CHECK(says(errorOf([&] { session.changePoints(some(), PaintPoints{1}); }), "a moving model cannot be sculpted"));
  CHECK(says(errorOf([&] { session.changePoints(some(), MovePoints()); }), "a moving model cannot be sculpted"));
}

}  // namespace palpate::selected_points_test
