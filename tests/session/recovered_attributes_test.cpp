// Masks and fields of a session that was cut off are recovered, and those of another model are refused.
#include <thread>

#include "engine/io/cloud_formats.hpp"
#include "haptics/session/recorded_edits.hpp"
#include "tests/error_of.hpp"
#include "tests/says.hpp"
#include "tests/session/attributed_person.hpp"

namespace palpate::kept_attributes_test {

TEST_CASE("the masks, fields and undo of a session that was cut off are recovered bit by bit") {
  const ScratchFolder folder;
  const InteractiveOptions kept{.unsavedIn = folder / "unsaved"};
  writeCloud(folder / "sphere.ply", sphereModel().cloud);
  std::vector<std::uint64_t> sums, undone;
  std::size_t undoCount = 0;
  const auto left = [&] { return leftStrokes(folder / "unsaved", [](const std::string& what) { FAIL_CHECK(what); }); };
  for (const bool hasStrokes : {false, true}) {
    CAPTURE(hasStrokes);
    {
      Person person(folder, kept);
      setSome(person, 700);
      if (hasStrokes) person.stroke();
      setSome(person, 100);
      CHECK(person.session.undo());
      if (hasStrokes) CHECK(person.session.undo());
      if (hasStrokes) CHECK(person.session.redo());
      person.session.setMask(MaskRole::hidden, PointSet::range(10, 20));
      person.session.setMask(MaskRole::hidden, {});  // as undo would do it
      CHECK(person.session.undo());
      sums = person.sums();
      undoCount = person.undoCount();
      person.goOn(0.3);
    }
    std::vector<LeftStrokes> found = left();
    REQUIRE(found.size() == 1);
    CHECK(found[0].since.made == undoCount);
    {
      Person again(folder, {.left = std::make_shared<const LeftStrokes>(std::move(found[0]))});
      CHECK(again.sums() == sums);
      CHECK(again.undoCount() == undoCount);
      CHECK(again.session.redo());
      CHECK(attributesOf(again.session.session()).mask(MaskRole::hidden).empty());
      while (again.session.undo()) again.goOn(0.01);
      CHECK(attributesOf(again.session.session()).fields().empty());
      CHECK_FALSE(attributesOf(again.session.session()).hasMasks());
      CHECK_FALSE(again.session.isChanged());
    }
    found.clear();
    for (LeftStrokes& each : left()) each.folder->remove();
  }
}

TEST_CASE("a field that was set after a save is recovered, and is still to be saved") {
  const ScratchFolder folder;
  const InteractiveOptions kept{.unsavedIn = folder / "unsaved"};
  writeCloud(folder / "sphere.ply", sphereModel().cloud);
  std::vector<std::uint64_t> sums;
  {
    Person person(folder, kept);
    setSome(person, 700);
    person.session.setMask(MaskRole::selected, {});  // else the next log begins at once
    person.stroke();
    REQUIRE(person.save((folder / "saved.ply").string()).failure == "");
    person.goOn(0.1);
    person.session.setField(0, PointSet::range(5, 6), bytesOf(std::vector<std::int64_t>{-7}));
    CHECK(person.session.isChanged());
    sums = person.sums();
    person.goOn(0.1);
  }
  std::vector<LeftStrokes> left = leftStrokes(folder / "unsaved", [](const std::string& what) { FAIL_CHECK(what); });
  REQUIRE(left.size() == 1);
  CHECK(left[0].since == StrokesSince{.made = 1});
  Person again(folder, {.unsavedIn = folder / "unsaved", .left = std::make_shared<const LeftStrokes>(left[0])});
  CHECK(again.sums() == sums);
  CHECK(again.session.isChanged());
}

TEST_CASE("a mask alone is recovered, and no longer offered once it is undone") {
  const ScratchFolder folder;
  const InteractiveOptions kept{.unsavedIn = folder / "unsaved"};
  writeCloud(folder / "sphere.ply", sphereModel().cloud);
  for (const bool isUndone : {false, true}) {
    {
      Person person(folder, kept);
      person.session.setMask(MaskRole::selected, PointSet::range(3, 30));
      for (int frame = 0; frame < 8; ++frame) {
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        if (isUndone && frame == 4) CHECK(person.session.undo());
        person.goOn(0.01);
      }
      CHECK_FALSE(person.session.isChanged());  // it is in no file
    }
    const auto left = leftStrokes(folder / "unsaved", [](const std::string& what) { FAIL_CHECK(what); });
    CHECK(left.size() == (isUndone ? 0 : 1));
    for (const LeftStrokes& each : left) each.folder->remove();
  }
}

TEST_CASE("a log whose change of a mask or a field does not belong to the model is refused by name") {
  const auto refusal = [](std::vector<AttributeChange> changes, bool hasGap = false) {
    SessionRecord record;
    record.edits.attributes = std::move(changes);
    record.edits.marks.assign(record.edits.attributes.size(), {0, EditMark::Kind::attribute});
    if (hasGap) record.gaps.push_back({.states = 0});
    const std::string why = errorOf<FileError>([&] { requireEditsOf("log", 10, record); });
    if (!why.empty()) return why;
    History history(PointCloud{.positions = std::vector<Vec3>(10)});
    LayerAttributes attributes;
    followAgain(history, attributes, record.edits);  // does not crash
    return fmt::format("{}", attributes.fields().size());
  };
  const FieldPresence made{.name = "a", .type = static_cast<std::uint8_t>(ScalarType::u16), .points = 10};
  const auto change = [](std::uint32_t field, std::uint64_t point, std::size_t bytes) {
    return FieldChange{
        .field = field, .points = PointSet::range(point, point + 1), .values = std::vector<std::byte>(bytes)};
  };
  CHECK(refusal({made, change(0, 9, 2)}) == "1");
  CHECK(refusal({MaskFlip{.points = PointSet::range(9, 11)}}) ==
        "log: is damaged: it refers to point 10, but with all its edits there are only 10");
  CHECK(says(refusal({made, change(0, 10, 2)}), "refers to point 10"));
  CHECK(says(refusal({FieldPresence{.name = "a", .points = 11}}), "refers to point 10"));
  CHECK(
      says(refusal({change(0, 9, 2)}), "it changes field 0, which does not exist or is another one; there are 0 then"));
  CHECK(says(refusal({made, change(1, 9, 2)}), "it changes field 1"));
  CHECK(says(refusal({made, change(0, 9, 3)}), "it changes field 0"));
  CHECK(says(refusal({made, made}), "there are 1 then"));
  CHECK(says(refusal({FieldPresence{.isPresent = false}}), "there are 0 then"));
  // Behind a gap in which the field was made.
  CHECK(refusal({change(0, 9, 2), MaskFlip{}}, true) == "0");
}

}  // namespace palpate::kept_attributes_test
