// Masks and fields are saved, handed on, recorded and replayed.
#include <doctest/doctest.h>

#include <fstream>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/saving.hpp"
#include "haptics/session/session_replay.hpp"
#include "tests/content_of.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/session/attributed_person.hpp"
#include "tests/splat_files.hpp"

namespace palpate::kept_attributes_test {

TEST_CASE("a saved file has the fields with their types to the last digit, and a format without them is named") {
  const ScratchFolder folder;
  Person person(folder);
  setSome(person, 1);
  person.stroke();
  const InteractiveSession::Saved saved = person.save((folder / "saved.ply").string());
  CHECK(saved.failure == "");
  CHECK(saved.remark == "");
  CHECK_FALSE(person.session.isChanged());
  const PointCloud expected = person.session.session().sculpted().cloud;
  REQUIRE(expected.extra.size() == 1);
  for (const char* const name : {"saved.ply", "saved.npz"}) {
    CAPTURE(name);
    if (std::string_view(name) != "saved.ply") CHECK(person.save((folder / name).string()).remark == "");
    const PointCloud read = readCloud(folder / name).cloud;
    REQUIRE(read.extra.size() == 1);
    CHECK(read.extra[0].name == "number");
    CHECK(read.extra[0].type == ScalarType::i64);
    CHECK(read.extra[0].data == expected.extra[0].data);
  }
  std::int64_t most = 0;
  for (std::size_t i = 0; i < expected.size(); ++i)
    most = std::max(most, loadScalar<std::int64_t>(expected.extra[0].data, i * sizeof most));
  CHECK(most == kLargest);
  const std::string remark = person.save((folder / "saved.pts").string()).remark;
  CHECK(says(remark, "not kept: "));
  CHECK(says(remark, "number"));
}

TEST_CASE("the lock of a splat scene is saved with its Gaussians, in a column behind all others, and read again") {
  const ScratchFolder folder;
  const test::SplatFile scene = test::splatBall(2, 900, {.floaters = 0.02, .faint = 0.3});
  std::ofstream(folder / "scene.ply", std::ios::binary) << scene.bytes();
  const PointCloud cloud = readCloud(folder / "scene.ply").cloud;
  CHECK(cloud.extra.empty());
  Field lock{.values = {std::string(kLockField), ScalarType::u8, {}}, .unit = {}};
  for (const Vec3& p : cloud.positions) lock.values.data.push_back(std::byte(p.x > 4 ? 255 : p.x > 0 ? 100 : 0));
  const PointCloud locked = editedCloud(cloud, statesOf(cloud), {lock});
  std::string lost;
  saveKeeping(folder / "locked.ply", locked, {.notKept = &lost});
  CHECK(lost == "");
  // Each row is that of the scene, and one byte.
  const std::string content = contentOf(folder / "locked.ply");
  const std::size_t row = 4 * scene.names.size(), bytes = scene.rows.size() * (row + 1);
  CHECK(says(content, fmt::format("property float {}\nproperty uchar lock\nend_header", scene.names.back())));
  REQUIRE(content.size() > bytes);
  std::size_t differing = 0, held = 0;
  for (std::size_t i = 0; i < scene.rows.size(); ++i) {
    const std::string read = content.substr(content.size() - bytes + i * (row + 1), row + 1);
    differing += read.substr(0, row) != scene.rows[i];
    held += static_cast<unsigned char>(read.back()) == 255;
  }
  CHECK(differing == 0);
  CHECK(held > 50);
  const PointCloud again = readCloud(folder / "locked.ply").cloud;
  REQUIRE(again.extra.size() == 1);
  CHECK(again.positions == cloud.positions);
  std::size_t other = 0;  // points that no Gaussian follows, at the borders
  for (std::size_t i = 0; i < cloud.size(); ++i) other += again.extra[0].data[i] != lock.values.data[i];
  CHECK(other < cloud.size() / 50);
  // Without a change they are the same bit by bit.
  saveKeeping(folder / "again.ply", editedCloud(again, statesOf(again), {}));
  CHECK((contentOf(folder / "again.ply") == content));
}

TEST_CASE("a session that continues with the points of another one has its masks and fields, and undoes them") {
  const ScratchFolder folder;
  std::vector<std::vector<std::uint64_t>> states;
  InteractiveSession::HandedOn handed;
  EditBatch removal;
  for (const PointState& state : statesOf(sphereModel().cloud))
    if (state.number % 7 == 6) removal.points.push_back(state), removal.points.back().gone = true;
  removal.marks = {{removal.points.size(), EditMark::Kind::stroke}};
  {
    Person person(folder, {.attributes = std::make_shared<const EditBatch>(removal)});
    person.session.setMask(MaskRole::hidden, PointSet::range(7, 56));
    person.stroke();
    REQUIRE(person.session.history().points().present() < 3500);
    states.push_back(person.sums());
    setSome(person, 700);
    states.push_back(person.sums());
    person.session.setMask(MaskRole::locked, PointSet::range(0, 4000));
    states.push_back(person.sums());
    CHECK(person.session.undo());
    handed = person.session.handOn();
    CHECK(person.sums() == states[1]);
    CHECK(person.session.redo());
    CHECK(person.sums() == states[2]);
  }
  CHECK(handed.model.cloud.extra.empty());
  // Points have other numbers, and so their masks other checksums: what the points have is compared.
  Person next(folder, {.attributes = handed.attributes}, handed.model);
  const auto selected = [&] { return attributesOf(next.session.session()).mask(MaskRole::selected).count(); };
  const auto& fields = attributesOf(next.session.session()).fields();
  CHECK(next.session.history().points().size() == handed.model.cloud.size());
  REQUIRE(fields.size() == 1);
  CHECK(checksumsOf(attributesOf(next.session.session()), next.session.history().points()).back() == states[1].back());
  CHECK(selected() > 1000);
  CHECK(attributesOf(next.session.session()).mask(MaskRole::hidden).count() == 42);
  CHECK(next.session.redo());
  CHECK(attributesOf(next.session.session()).mask(MaskRole::locked).count() > 3400);
  for (int i = 0; i < 2; ++i) CHECK(next.session.undo());
  CHECK(std::ranges::count(fields[0].values.data, std::byte{0}) ==
        static_cast<std::ptrdiff_t>(fields[0].values.data.size()));
  CHECK(next.session.undo());
  CHECK(fields.empty());
  CHECK(next.session.undo());
  CHECK(selected() == 0);
  CHECK(attributesOf(next.session.session()).mask(MaskRole::hidden).count() == 42);
}

namespace {

struct Replay {
  Recorded recorded;
  SessionAgain again;
  ReplayOutcome outcome;

  Replay(const std::string& log, const PointCloud& cloud) {
    std::vector<std::unique_ptr<BackendKind>> kinds;
    kinds.push_back(cpuBackend());
    const Backends backends(std::move(kinds));
    Log silent(true);
    const ReplayParts parts{.backends = backends, .log = silent, .threads = 1, .cloud = &cloud};
    recorded = loadRecorded(log, parts);
    again = runAgain(recorded, parts);
    outcome = compareRuns(recorded, again, 0);
  }
  void check(const std::vector<std::uint64_t>& sums) const {
    CAPTURE(outcome.comparable.because);
    CHECK(recorded.endsAsRecorded == true);
    CHECK(outcome.isWhole(recorded));
    CHECK(outcome.differences.attributes == 0);
    CHECK(checksumsOf(recorded.attributes, recorded.points) == sums);
    CHECK(checksumsOf(again.attributes, again.points) == sums);
  }
};

}  // namespace

TEST_CASE("a replay repeats changes of masks and fields among strokes, and their undo, bit by bit") {
  const ScratchFolder folder;
  const std::string log = (folder / "log").string();
  for (const bool isInContact : {false, true}) {
    CAPTURE(isInContact);
    Person person(folder);
    const PointCloud cloud = person.session.model().cloud;
    // Before the recording: set, and undone in part.
    setSome(person, 1000);
    person.session.setMask(MaskRole::selected, PointSet::range(0, 3000));
    CHECK(person.session.undo());
    CHECK(person.session.undo());
    person.session.aim({0, 0, 55});
    person.goOn(0.2);
    if (isInContact) person.session.aim({0, 0, 49.6});
    person.goOn(0.3);
    CHECK(person.session.recentTicks().rows().back().contact == isInContact);
    person.session.record(log);
    person.goOn(0.05);
    CHECK(person.session.redo());
    person.stroke();
    setSome(person, 2000);
    person.stroke();
    CHECK(person.session.undo());
    CHECK(person.session.undo());
    CHECK(person.session.redo());
    person.goOn(0.05);
    const std::vector<std::uint64_t> sums = person.sums();
    person.session.endRecording();
    Replay(log, cloud).check(sums);
    // Undone beyond the beginning of the recording, and another field instead.
    for (std::size_t i = person.undoCount(); i > 0; --i) CHECK(person.session.undo());
    CHECK(attributesOf(person.session.session()).fields().empty());
  }
}

TEST_CASE("a replay goes back to before the masks and fields with which the recording began") {
  const ScratchFolder folder;
  const std::string log = (folder / "log").string();
  Person person(folder);
  const PointCloud cloud = person.session.model().cloud;
  setSome(person, 1000);
  person.goOn(0.02);
  person.session.record(log);
  person.goOn(0.02);
  for (int i = 0; i < 2; ++i) CHECK(person.session.undo());
  const std::uint32_t other = person.session.fieldNamed("other", ScalarType::u8);
  CHECK(other == 0);
  person.session.setField(other, PointSet::range(3, 6), bytesOf(std::vector<std::uint8_t>{1, 2, 3}));
  person.goOn(0.02);
  const std::vector<std::uint64_t> sums = person.sums();
  person.session.endRecording();
  const Replay replay(log, cloud);
  replay.check(sums);
  CHECK(replay.again.attributes.fields()[0].values.name == "other");
}

TEST_CASE("a mask that is set while a stroke is in progress ends it, and is undone before it, also in a replay") {
  const ScratchFolder folder;
  const std::string log = (folder / "log").string();
  Person person(folder);
  const PointCloud cloud = person.session.model().cloud;
  person.goOn(0.02);
  person.session.record(log);
  person.session.aim({0, 0, 55});
  person.goOn(0.2);
  person.session.aim({0, 0, 46});
  for (int i = 0; i < 100 && person.session.edits() == 0; ++i) person.goOn(0.01);
  REQUIRE(person.session.edits() > 0);
  person.session.setMask(MaskRole::selected, PointSet::range(0, 4000));
  CHECK(person.undoCount() == 2);
  person.goOn(0.1);
  person.session.lift();
  person.goOn(0.5);
  CHECK(person.undoCount() == 3);
  for (int i = 0; i < 2; ++i) CHECK(person.session.undo());
  CHECK(existing(attributesOf(person.session.session()).mask(MaskRole::selected), person.session.history().points())
            .empty());
  CHECK(person.session.redo());
  person.goOn(0.02);
  const std::vector<std::uint64_t> sums = person.sums();
  person.session.endRecording();
  Replay(log, cloud).check(sums);
}

TEST_CASE("a replay of a log that lacks the making of a field leaves its changes out") {
  const ScratchFolder folder;
  const std::string log = (folder / "log").string();
  Person person(folder);
  const PointCloud cloud = person.session.model().cloud;
  person.goOn(0.02);
  person.session.record(log);
  person.goOn(0.02);
  setSome(person, 1000);
  person.goOn(0.02);
  person.session.endRecording();
  std::string content = contentOf(log);
  const std::size_t at = content.find("number", content.find("blck"));
  REQUIRE(at != content.npos);
  content[at] = 'N';
  std::ofstream(log, std::ios::binary) << content;
  const Replay replay(log, cloud);
  CHECK(replay.recorded.record.gaps.size() == 1);
  CHECK(replay.recorded.endsAsRecorded == false);
  for (const LayerAttributes* each : {&replay.recorded.attributes, &replay.again.attributes}) {
    CHECK(each->fields().empty());
    CHECK(each->mask(MaskRole::selected) == PointSet::range(1000, 2500));
  }
}

TEST_CASE("masks and fields that are set before a recorded run, and after it, are in its replay") {
  const ScratchFolder folder;
  const std::string log = (folder / "log").string();
  const auto cpu = cpuBackend();
  Session session(carving((folder / "sphere.ply").string()), sphereModel(),
                  {.backend = *cpu, .threads = 1, .keepsPoints = true, .undo = {1 << 26}});
  session.setMask(MaskRole::within, PointSet::range(0, 2000));
  const PathHand hand(strokeFrom({0, 0, 1}, 8));
  const OpenHand open = hand.hand();
  session.record(log, open);
  const std::uint32_t heat = session.fieldNamed("heat");
  session.setField(heat, PointSet::range(9, 11), bytesOf(std::vector<float>{1, -0.0f}));
  session.run({&open, 1}, {});
  session.finish();
  session.setMask(MaskRole::hidden, PointSet::range(100, 5000));
  session.endRecording();
  const Replay replay(log, session.model().cloud);
  replay.check(sumsOf(session));
  // A difference is found.
  SessionAgain again = replay.again;
  AttributeChange flip = MaskFlip{.role = MaskRole::hidden, .points = PointSet::range(7, 8)};
  again.attributes.exchange(flip);
  const ReplayOutcome differing = compareRuns(replay.recorded, again, 0);
  CHECK(differing.differences.attributes == 1);
  const DVec3& origin = session.model().cloud.origin;
  CHECK(checksumOf(origin, again.points, again.attributes) != session.endChecksum());
  CHECK(checksumOf(origin, again.points, LayerAttributes()) == checksumOf(origin, again.points));
  CHECK_FALSE(differing.isWhole(replay.recorded));
}

}  // namespace palpate::kept_attributes_test
