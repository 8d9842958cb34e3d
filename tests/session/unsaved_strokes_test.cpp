// Strokes that are not saved yet: what a program leaves of them at its end, and which program may take them over.
#include <doctest/doctest.h>

#include <fstream>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/checksum.hpp"
#include "engine/core/packed_state.hpp"
#include "haptics/session/model.hpp"
#include "haptics/session/recorded_edits.hpp"
#include "haptics/session/unsaved_strokes.hpp"
#include "tests/content_of.hpp"
#include "tests/history_steps.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::unsaved_strokes_test {

namespace {

constexpr std::uint64_t kUndo_bytes = 1 << 20;

struct Sculpted {
  explicit Sculpted(const std::filesystem::path& root) : unsaved(root, model) {
    unsaved.describe({.config = {.model = {.file = (root / "model.ply").string()}}, .machine = "one", .palpate = "1"});
  }
  void take(EditBatch batch) {
    attributes.follow(batch, history.points());
    history.follow(batch);
    const bool isChanged = history.version() != 0 || since.undone > 0 || attributes.hasMasks();
    unsaved.follow(batch, history.points(), attributes, isChanged, since);
  }
  // Moves points of the cloud, or appends one.
  void stroke(const std::vector<std::uint32_t>& points, float to) {
    EditBatch batch;
    for (const std::uint32_t id : points)
      batch.points.push_back({.position = Vec3(to), .number = id, .normal = {0, 0, 1}, .parent = std::min(id, 1u)});
    batch.marks.push_back({batch.points.size(), EditMark::Kind::stroke});
    take(std::move(batch));
  }
  // A back end's report of an undo.
  void change(const std::vector<PointChange>& changes) {
    EditBatch batch;
    for (const PointChange& each : changes) batch.points.push_back(each.to);
    batch.marks.push_back({batch.points.size(), EditMark::Kind::change});
    take(std::move(batch));
  }

  StrokesSince since;
  Model model{.cloud = {.positions = {Vec3(0), Vec3(1)}, .normals = {Vec3(0, 0, 1), Vec3(0, 0, 1)}}};
  History history{model.cloud, {kUndo_bytes}};
  LayerAttributes attributes;
  UnsavedStrokes unsaved;
};

std::vector<LeftStrokes> leftIn(const std::filesystem::path& root) {
  return leftStrokes(root, [](const std::string& what) { FAIL_CHECK(what); });
}

/// What a history has at one moment.
struct Snapshot {
  explicit Snapshot(const History& history)
      : points(history.points().begin(), history.points().end()), counts(history.counts()) {}

  std::vector<PointState> points;
  StrokeCounts counts;
};

void checkSame(const History& a, const Snapshot& b) {
  CHECK(std::ranges::equal(a.points(), b.points));
  CHECK(a.counts().undoCount == b.counts.undoCount);
  CHECK(a.counts().redoCount == b.counts.redoCount);
}

}  // namespace

TEST_CASE("unsaved strokes are recovered unchanged, including undone and redone ones") {
  const ScratchFolder folder;
  std::optional<Sculpted> sculpted(std::in_place, folder.path());
  sculpted->stroke({0}, 3);
  sculpted->stroke({1, 2}, 4);
  sculpted->change(undone(sculpted->history));
  sculpted->change(redone(sculpted->history));
  sculpted->change(undone(sculpted->history));
  History again(sculpted->model.cloud, {kUndo_bytes});
  const Snapshot before(sculpted->history);
  CHECK(leftIn(folder.path()).empty());  // while the program runs
  sculpted.reset();
  const std::vector<LeftStrokes> left = leftIn(folder.path());
  REQUIRE(left.size() == 1);
  CHECK(left[0].since.made == 2);
  CHECK(left[0].document() == (folder / "model.ply").string());
  LayerAttributes attributes;
  followAgain(again, attributes, left[0].edits);
  checkSame(again, before);
  redone(again);
  CHECK(again.points()[2].position == Vec3(4));
}

namespace {

// A log of version 4, with its 32-bit numbers.
void writeVersion4(const std::filesystem::path& file, std::string text, const EditBatch& edits) {
  struct {
    std::array<char, 8> magic = session_file::kMagic;
    std::uint32_t version = 4, textBytes = 0;
    std::uint64_t checksum = 0;
  } header;
  struct {
    std::uint32_t magic = 0x6b636c62, number = 0, ticks = 0, states = 0, marks = 0, last = 0;
    std::uint64_t merged = 0;
    SessionEnd end;
    std::uint64_t checksum = 0, ticksBefore = 0, statesBefore = 0;
  } block;
  static_assert(sizeof header == 24 && sizeof block == 72);
  std::string bytes;
  const auto add = [&](const auto& values) {
    const auto all = std::as_bytes(std::span(values));
    bytes.append(reinterpret_cast<const char*>(all.data()), all.size());
  };
  text.resize((text.size() + 7) / 8 * 8, ' ');
  header.textBytes = static_cast<std::uint32_t>(text.size());
  Checksum ofHeader;
  ofHeader.add(std::as_bytes(std::span(&header, 1)));
  ofHeader.add(std::as_bytes(std::span(text)));
  header.checksum = ofHeader.value();
  for (int copy = 0; copy < 2; ++copy) add(std::span(&header, 1)), add(text);
  std::vector<session_file::Mark> marks;
  for (const EditMark& mark : edits.marks) marks.push_back({mark.at, static_cast<std::uint64_t>(mark.kind)});
  block.states = static_cast<std::uint32_t>(edits.points.size());
  block.marks = static_cast<std::uint32_t>(marks.size());
  std::vector<PackedState> states;
  for (const PointState& state : edits.points) states.push_back(packedState(state));
  Checksum ofBlock;
  ofBlock.add(std::as_bytes(std::span(&block, 1)));
  ofBlock.add(std::as_bytes(std::span(states)));
  ofBlock.add(std::as_bytes(std::span(marks)));
  block.checksum = ofBlock.value();
  add(std::span(&block, 1)), add(states), add(marks);
  std::ofstream(file, std::ios::binary) << bytes;
}

}  // namespace

TEST_CASE("unsaved strokes of the version before are offered, and those of other versions are kept") {
  const ScratchFolder folder;
  std::optional<Sculpted> sculpted(std::in_place, folder.path());
  sculpted->stroke({0}, 3);
  sculpted->stroke({1, 2}, 4);
  const Snapshot before(sculpted->history);
  History again(sculpted->model.cloud, {kUndo_bytes});
  sculpted.reset();
  std::filesystem::path log;
  {
    const auto left = leftIn(folder.path());
    REQUIRE(left.size() == 1);
    log = left[0].folder->log(left[0].folder->logs().back());
  }
  const SessionRecord record = readSessionLog(log);
  writeVersion4(log, record.text, record.edits);
  CHECK_THROWS_WITH_AS(readSessionLog(log), doctest::Contains("version 4"), FileError);
  {
    const auto left = leftIn(folder.path());
    REQUIRE(left.size() == 1);
    CHECK(left[0].since.made == 2);
    LayerAttributes attributes;
    followAgain(again, attributes, left[0].edits);
    checkSame(again, before);
  }
  std::string older = contentOf(log);
  older[8] = older[24 + static_cast<std::size_t>(record.text.size()) + 8] = 3;
  std::ofstream(log, std::ios::binary) << older;
  std::string reported;
  CHECK(leftStrokes(folder.path(), [&](const std::string& what) { reported = what; }).empty());
  CHECK(reported.find("version 3") != std::string::npos);
  CHECK(contentOf(std::filesystem::path(log.parent_path().string() + ".damaged") / log.filename()) == older);
}

TEST_CASE("what unsaved strokes change in the file saved last is kept with them, also where nothing but undo is left") {
  const ScratchFolder folder;
  {
    Sculpted sculpted(folder.path());
    sculpted.since = {.made = 1};
    sculpted.stroke({0}, 3);
    sculpted.unsaved.saved(sculpted.history.points(), sculpted.attributes);
    sculpted.since = {.made = 0, .undone = 1};
    sculpted.change(undone(sculpted.history));
  }
  const auto left = leftIn(folder.path());
  REQUIRE(left.size() == 1);
  CHECK(left[0].since == StrokesSince{.made = 0, .undone = 1});
  const PointCloud loaded{.positions = {Vec3(0), Vec3(1)}, .normals = {Vec3(0, 0, 1), Vec3(0, 0, 1)}};
  History again(loaded, {kUndo_bytes});
  LayerAttributes attributes;
  followAgain(again, attributes, left[0].edits);
  CHECK(std::ranges::equal(again.points(), statesOf(loaded)));
}

TEST_CASE("masks that are in no saved file are kept also after a save") {
  const ScratchFolder folder;
  {
    Sculpted sculpted(folder.path());
    AttributeChange flip = MaskFlip{.points = PointSet::range(1, 2)};
    EditBatch batch{.marks = {{0, EditMark::Kind::attribute}}, .attributes = {flip}};
    sculpted.attributes.exchange(flip);
    sculpted.take(std::move(batch));
    sculpted.unsaved.saved(sculpted.history.points(), sculpted.attributes);
    sculpted.take({});  // the next frame
  }
  const auto left = leftIn(folder.path());
  REQUIRE(left.size() == 1);
  CHECK(left[0].since == StrokesSince());
  History history(PointCloud{.positions = {Vec3(0), Vec3(1)}});
  LayerAttributes attributes;
  followAgain(history, attributes, left[0].edits);
  CHECK(attributes.mask(MaskRole::selected) == PointSet::range(1, 2));
}

TEST_CASE("a stroke in progress is counted among the unsaved strokes") {
  const ScratchFolder folder;
  {
    Sculpted sculpted(folder.path());
    sculpted.stroke({0}, 3);
    sculpted.take({.points = {{.position = Vec3(4), .number = 1, .normal = {0, 0, 1}, .parent = 1}}});
  }
  const auto left = leftIn(folder.path());
  REQUIRE(left.size() == 1);
  CHECK(left[0].since.made == 2);
}

TEST_CASE("a stroke that is written while it goes on is recovered as one, and undone as a whole, also after a save") {
  for (const bool saves : {false, true}) {
    CAPTURE(saves);
    const ScratchFolder folder;
    std::vector<PointState> before;
    std::optional<Sculpted> sculpted(std::in_place, folder.path());
    if (saves) {
      sculpted->stroke({0, 2}, 3);
      sculpted->unsaved.saved(sculpted->history.points(), sculpted->attributes);
    }
    before.assign(sculpted->history.points().begin(), sculpted->history.points().end());
    for (const float to : {4.0F, 5.0F})
      sculpted->take({.points = {{.position = Vec3(to), .number = 1, .normal = {0, 0, 1}, .parent = 1}}});
    sculpted->stroke({0}, 6);
    const Model model = sculpted->model;
    sculpted.reset();
    const auto left = leftIn(folder.path());
    REQUIRE(left.size() == 1);
    History again(model.cloud, {kUndo_bytes});
    LayerAttributes attributes;
    followAgain(again, attributes, left[0].edits);
    CHECK(again.points()[1].position == Vec3(5));
    CHECK(again.counts().undoCount == 1);
    undone(again);
    CHECK(std::ranges::equal(again.points(), before));
  }
}

TEST_CASE("saved strokes are not left, and later ones are relative to the model's file as it was") {
  const ScratchFolder folder;
  std::ofstream(folder / "model.ply") << "as it was";
  std::optional<Sculpted> sculpted(std::in_place, folder.path());
  sculpted->stroke({0}, 3);
  sculpted->unsaved.keepModel();
  std::ofstream(folder / "new.ply") << "saved";
  std::filesystem::rename(folder / "new.ply", folder / "model.ply");
  sculpted->unsaved.saved(sculpted->history.points(), sculpted->attributes);
  sculpted->unsaved.setDocument((folder / "mine.ply").string());
  sculpted->stroke({1}, 5);
  const Snapshot before(sculpted->history);
  const Model model = sculpted->model;
  sculpted.reset();
  std::vector<LeftStrokes> left = leftIn(folder.path());
  REQUIRE(left.size() == 1);
  CHECK(left[0].document() == (folder / "mine.ply").string());
  std::string kept;
  std::getline(std::ifstream(left[0].model().file), kept);
  CHECK(kept == "as it was");
  CHECK_NOTHROW(left[0].requireModel(model));
  CHECK_THROWS_WITH_AS(left[0].requireModel(Model{}), doctest::Contains("has changed since"), FileError);
  History again(model.cloud, {kUndo_bytes});
  LayerAttributes attributes;
  followAgain(again, attributes, left[0].edits);
  CHECK(std::ranges::equal(again.points(), before.points));
  left[0].folder->remove();
  left.clear();
  CHECK(leftIn(folder.path()).empty());
}

TEST_CASE("recovered strokes stay recoverable while work continues, and are deleted when unwanted") {
  const ScratchFolder folder;
  std::optional<Sculpted>(std::in_place, folder.path())->stroke({0}, 3);
  {
    const std::vector<LeftStrokes> left = leftIn(folder.path());
    REQUIRE(left.size() == 1);
    Sculpted next(folder.path());
    followAgain(next.history, next.attributes, left[0].edits);
    next.unsaved.adopt(left[0]);
    next.since = {.made = 2};
    next.stroke({1}, 4);
  }
  std::vector<LeftStrokes> left = leftIn(folder.path());
  REQUIRE(left.size() == 1);
  CHECK(left[0].since.made == 2);
  Sculpted last(folder.path());
  last.unsaved.adopt(left[0]);
  left.clear();
  last.unsaved.remove();
  CHECK(leftIn(folder.path()).empty());
  CHECK(std::filesystem::is_empty(folder.path()));
}

TEST_CASE("a folder where strokes cannot be kept is reported once, and work continues") {
  const ScratchFolder folder;
  std::ofstream(folder / "file") << "no folder";
  Sculpted sculpted(folder / "file");
  sculpted.stroke({0}, 3);
  std::optional<std::string> fault;
  for (int i = 0; i < 400 && !fault; ++i) {
    sculpted.stroke({1}, 4);
    fault = sculpted.unsaved.takeFault();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  REQUIRE(fault);
  CHECK(says(*fault, "would be lost"));
  sculpted.stroke({1}, 5);
  CHECK_FALSE(sculpted.unsaved.takeFault());
}

TEST_CASE("strokes that were all undone are not offered again; redone ones are") {
  const ScratchFolder folder;
  const auto strokesLeft = [&](bool again) {
    {
      Sculpted sculpted(folder.path());
      sculpted.stroke({0}, 3);
      // Until it is written, as the window does it from picture to picture.
      const auto look = [&] {
        for (int i = 0; i < 8; ++i) {
          std::this_thread::sleep_for(std::chrono::milliseconds(30));
          sculpted.take({});
        }
      };
      look();
      sculpted.change(undone(sculpted.history));
      look();
      if (again) sculpted.change(redone(sculpted.history));
    }
    const std::vector<LeftStrokes> left = leftIn(folder.path());
    const std::size_t count = left.size();
    for (const LeftStrokes& each : left) each.folder->remove();
    return count;
  };
  CHECK(strokesLeft(false) == 0);
  CHECK(std::filesystem::is_empty(folder.path()));
  CHECK(strokesLeft(true) == 1);
}

TEST_CASE("damaged unsaved strokes are reported once and kept under another name") {
  const ScratchFolder folder;
  const auto damage = [&] {
    std::filesystem::create_directory(folder / "1-1");
    for (const char* name : {"lock", "strokes-1.log"}) std::ofstream(folder / "1-1" / name) << "torn";
  };
  std::vector<std::string> said;
  const auto look = [&] {
    CHECK(leftStrokes(folder.path(), [&](const std::string& what) { said.push_back(what); }).empty());
  };
  damage();
  look();
  look();
  REQUIRE(said.size() == 1);
  CHECK(says(said[0], "strokes-1.log"));
  CHECK(says(said[0], (folder / "1-1.damaged").string()));
  damage();
  look();
  CHECK(said.size() == 2);
  for (const char* name : {"1-1.damaged", "1-1.damaged2"})
    CHECK(std::filesystem::exists(folder / name / "strokes-1.log"));
}

TEST_CASE("a log that a program had no time to begin does not hide the one before it") {
  const ScratchFolder folder;
  std::optional<Sculpted>(std::in_place, folder.path())->stroke({0}, 3);
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    std::ofstream(entry.path() / "strokes-2.log") << "torn";
  const std::vector<LeftStrokes> left = leftIn(folder.path());
  REQUIRE(left.size() == 1);
  CHECK(left[0].since.made == 1);
}

}  // namespace palpate::unsaved_strokes_test
