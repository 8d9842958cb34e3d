#include "haptics/session_log.hpp"

#include <random>

#include "engine/cloud/attribute_bytes.hpp"
#include "engine/core/checksum.hpp"
#include "engine/core/error.hpp"
#include "haptics/devices/replay_device.hpp"
#include "tests/haptics/logged_session.hpp"

namespace palpate::session_log_test {

TEST_CASE("a session log is read back as written") {
  const ScratchFolder folder;
  writeSession(folder / "log", 1234);
  const SessionRecord record = readSessionLog(folder / "log");
  CHECK(record.text.starts_with("a text"));
  CHECK(record.ticks.size() == 1234);
  CHECK(record.edits.points.size() == 3 * 1234);
  CHECK(record.edits.marks.size() == 123);
  checkBeginning(record);
  REQUIRE(record.end);
  CHECK(record.end->points == 77);
  CHECK(record.end->lostTicks == 0);
  CHECK(record.wholeBytes == record.fileBytes);
  CHECK(record.fileBytes == std::filesystem::file_size(folder / "log"));
}

TEST_CASE("changes of masks and fields are read back in order with strokes, whatever the size of their blocks") {
  const ScratchFolder folder;
  EditBatch all;
  std::mt19937 random(3);
  for (std::uint32_t i = 0; i < 200; ++i) {
    append(all, editsAt(i));
    const unsigned kind = random() % 4;
    if (kind == 0) all.points.insert(all.points.end(), random() % 600, PointState());
    if (kind == 1) all.attributes.push_back(changeOf(i, 1 + random() % 3000));
    if (kind == 2) all.attributes.push_back(MaskFlip{.role = MaskRole::locked, .points = PointSet::range(i, 9000)});
    if (kind == 3)
      all.attributes.push_back(FieldPresence{
          .field = i, .isPresent = i % 2 == 0, .name = "höhe", .unit = "m", .type = 9, .points = i, .values = {}});
    if (kind > 0) all.marks.push_back({all.points.size(), i % 3 ? EditMark::Kind::attribute : EditMark::Kind::redone});
  }
  {
    SessionWriter writer(folder / "log", "a text");
    writer.add(all);
    // What new points took from their parents is found again from their states.
    writer.add(EditBatch{.points = {{.number = 1}}, .attributes = {MaskFlip{}}});
    const EditBatch last{.marks = {{0, EditMark::Kind::undone}}, .attributes = {changeOf(5, 7)}};
    writer.add(last);
    writer.finish(77);
    all.points.push_back({.number = 1});
    append(all, last);
  }
  const SessionRecord record = readSessionLog(folder / "log");
  REQUIRE(record.end);
  CHECK(record.gaps.empty());
  CHECK(record.edits.points.size() == all.points.size());
  CHECK(record.edits.marks == all.marks);
  CHECK(record.edits.attributes == all.attributes);
}

namespace {

void writeUnder(const std::filesystem::path& file, std::string content, std::uint32_t version) {
  session_file::Header header;
  std::memcpy(&header, content.data(), sizeof header);
  const std::string text = content.substr(sizeof header, header.textBytes);
  header.version = version;
  header.checksum = 0;
  Checksum sum;
  sum.add(std::as_bytes(std::span(&header, 1)));
  sum.add(std::as_bytes(std::span(text)));
  header.checksum = sum.value();
  for (const std::size_t at : {std::size_t{0}, sizeof header + text.size()})
    std::memcpy(content.data() + at, &header, sizeof header);
  write(file, content);
}

}  // namespace

TEST_CASE("logs of the versions before are read, and one of the version after is refused as of a newer program") {
  const ScratchFolder folder;
  writeSession(folder / "log", 200);
  for (const std::uint32_t version : {5u, 6u}) {
    writeUnder(folder / "before", contentOf(folder / "log"), version);
    const SessionRecord before = readSessionLog(folder / "before");
    checkBeginning(before);
    CHECK(before.ticks.size() == 200);
    CHECK(before.edits.marks == readSessionLog(folder / "log").edits.marks);
    CHECK(before.end);
    CHECK(readLoggedEdits(folder / "before").edits.points.size() == 600);
  }
  writeUnder(folder / "after", contentOf(folder / "log"), session_file::kVersion + 1);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "after"), doctest::Contains("version 8, of a newer palpate"), FileError);
}

TEST_CASE("a truncated or unknown change of a mask costs its block, and is reported") {
  const ScratchFolder folder;
  const auto hostile = [&](std::vector<std::byte> content) {
    SessionLogFile file(folder / "log", "a text", {});
    const session_file::Mark mark{.at = 0, .kind = 4, .bytes = content.size()};
    content.resize((content.size() + 7) / 8 * 8);
    file.append({.marks = {&mark, 1}, .attribute = content});
    const SessionEnd end;
    file.append({.end = &end});
    file.close();
    return readSessionLog(folder / "log");
  };
  const auto whole = bytesIn(MaskFlip{.points = PointSet::range(3, 300)});
  CHECK(hostile(whole).edits.attributes.size() == 1);
  const auto check = [&](const SessionRecord& record) {
    CHECK(record.edits.attributes.empty());
    CHECK(record.edits.marks.empty());
    REQUIRE(record.gaps.size() == 1);
    CHECK(record.end);
    CHECK(saysOneOf(whatIsMissing(record), "are damaged: 0 ticks, 1 command and 0 edits of points"));
  };
  for (const std::size_t size : {std::size_t{7}, std::size_t{24}, std::size_t{40}, whole.size() - 8})
    check(hostile({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)}));
  const auto changed = [&](std::size_t word, std::uint64_t value) {
    auto bytes = whole;
    std::memcpy(bytes.data() + 8 * word, &value, sizeof value);
    return bytes;
  };
  check(hostile(changed(0, 3)));                  // kind
  check(hostile(changed(1, 1)));                  // layer
  check(hostile(changed(2, kMaskRoles)));         // role
  check(hostile(changed(3, ~std::uint64_t{0})));  // pages
  check(hostile(changed(4, ~std::uint64_t{0})));  // number of a page
  check(hostile(changed(5, 2)));                  // words of a page
  check(hostile(bytesIn(FieldPresence{.name = "a", .type = 10})));
}

TEST_CASE("an empty session is a complete log, and an unfinished one has no end") {
  const ScratchFolder folder;
  writeSession(folder / "none", 0);
  CHECK(readSessionLog(folder / "none").ticks.empty());
  CHECK(readSessionLog(folder / "none").end);
  writeSession(folder / "open", 300, false);
  const SessionRecord open = readSessionLog(folder / "open");
  CHECK(open.ticks.size() == 300);
  CHECK_FALSE(open.end);
  CHECK(open.wholeBytes == open.fileBytes);
}

TEST_CASE("a missing log, another file and another version are refused with a reason") {
  const ScratchFolder folder;
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "none"), doctest::Contains("cannot be opened"), FileError);
  for (const std::string& content : {std::string(), std::string("ply\n"), std::string(1000, 'x')}) {
    write(folder / "bad", content);
    CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"), doctest::Contains("not a session log"), FileError);
  }
  writeSession(folder / "log", 10);
  std::string newer = contentOf(folder / "log");
  for (const std::size_t header : {0u, 40u}) newer[header + 8] = 9;
  write(folder / "bad", newer);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"), doctest::Contains("version 9, of a newer palpate"), FileError);
  for (const std::size_t header : {0u, 40u}) newer[header + 8] = 4;
  write(folder / "bad", newer);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"),
                       doctest::Contains("bad: is a session log of version 4, and this palpate reads versions 5 to 7"),
                       FileError);
  for (const std::size_t header : {0u, 40u}) newer[header + 8] = 5, newer[header + 16] = 1;
  write(folder / "bad", newer);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"), doctest::Contains("with the force law 1"), FileError);
  std::string huge = contentOf(folder / "log");
  for (const std::size_t header : {0u, 40u}) std::memset(huge.data() + header + 12, 0xFF, 4);
  write(folder / "bad", huge);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"), doctest::Contains("damaged"), FileError);
  CHECK_THROWS_AS(SessionWriter(folder / "no" / "where", ""), FileError);
}

// A program that does not know what is in a log calls it damaged, unless its version is higher.
TEST_CASE("the version of a log stands for the layout of its changes") {
  PointSet points = PointSet::range(3, 70);
  const std::vector<AttributeChange> changes{
      MaskFlip{.role = MaskRole::locked, .points = points},
      FieldChange{.field = 1, .points = PointSet::range(0, 2), .values = {std::byte{1}, std::byte{2}}},
      FieldPresence{.name = "a", .unit = "mm", .type = 1, .points = 2, .values = {std::byte{7}, std::byte{8}}},
      StrokeLayerChange{.set = {.name = "b", .strength = 0.5, .held = {{7, 0.25}}},
                        .open = 0,
                        .points = {{.before = {.number = 7}, .after = {.number = 7}}},
                        .places = {{.number = 7, .one = {1, 2, 3}, .kind = LayerPlace::Kind::merged}}}};
  static_assert(std::variant_size_v<AttributeChange> == 4);
  Checksum layout;
  for (const AttributeChange& change : changes) {
    const std::vector<std::byte> bytes = bytesIn(change);
    layout.add(bytes);
    AttributeChange again;
    REQUIRE(readChange(bytes, again));
    CHECK(again == change);
  }
  CHECK(session_file::kVersion == 7);
  CHECK(layout.value() == 6951736543620209688u);  // another one: raise the version
}

TEST_CASE("a log keeps an older log of its name, and replaces no other file and none that is being written") {
  const ScratchFolder folder;
  write(folder / "notes", "notes");
  CHECK_THROWS_WITH_AS(SessionWriter(folder / "notes", ""), doctest::Contains("exists, and is not a session log"),
                       FileError);
  CHECK(contentOf(folder / "notes") == "notes");
  writeSession(folder / "log", 10);
  {
    const SessionWriter first(folder / "log", "first");
    const std::string begun = contentOf(folder / "log");
    CHECK_THROWS_WITH_AS(SessionWriter(folder / "log", "second"), doctest::Contains("written by another program"),
                         FileError);
    CHECK(contentOf(folder / "log") == begun);
  }
  writeSession(folder / "log", 20);
  CHECK(readSessionLog(folder / "log").ticks.size() == 20);
  CHECK(readSessionLog(folder / "log.bak").ticks.size() == 10);
  CHECK(SessionWriter(folder / "log", "").keptAs() == std::filesystem::canonical(folder.path()) / "log.bak3");
  CHECK(readSessionLog(folder / "log.bak3").ticks.size() == 20);
}

TEST_CASE("adding a tick never waits: ticks faster than they can be written are lost and counted") {
  const ScratchFolder folder;
  SessionWriter writer(folder / "log", "");
  std::uint64_t added = 0;
  while (writer.lostTicks() == 0 && added < 100'000'000) writer.add(tickAt(added++));
  CHECK(writer.lostTicks() > 0);
  writer.finish(0);
  const SessionRecord record = readSessionLog(folder / "log");
  REQUIRE(record.end);
  CHECK(record.end->lostTicks == writer.lostTicks());
  CHECK(record.ticks.size() + record.end->lostTicks == added);
}

TEST_CASE("edits faster than the disk are merged, and give the same points") {
  const ScratchFolder folder;
  constexpr std::uint32_t kPoints = 5000;
  std::vector<std::uint32_t> last(kPoints);
  std::uint64_t told = 0;
  SessionWriter writer(folder / "log", "");
  std::mt19937 random(3);
  // Passed at once, so that no disk is fast enough.
  EditBatch all;
  for (std::uint32_t stroke = 1; stroke <= 3; ++stroke) {
    for (int i = 0; i < 1'000'000; ++i) {
      const auto id = static_cast<std::uint32_t>(random() % kPoints);
      all.points.push_back({.number = id, .color = last[id] = ++told % 1'000'003});
    }
    all.marks.push_back({all.points.size(), EditMark::Kind::stroke});
  }
  writer.add(all);
  CHECK(writer.waitingEdits() <= 3 * kPoints);
  writer.finish(0);
  CHECK(writer.mergedEdits() == told - 3 * kPoints);
  const SessionRecord record = readSessionLog(folder / "log");
  CHECK(record.mergedEdits == writer.mergedEdits());
  CHECK(record.countedEdits == 0);
  REQUIRE(record.edits.points.size() == 3 * kPoints);
  for (std::size_t i = 0; i < 3; ++i) CHECK(record.edits.marks[i].at == kPoints * (i + 1));
  std::size_t wrong = 0;
  for (std::size_t i = 2 * kPoints; i < 3 * kPoints; ++i)
    wrong += record.edits.points[i].color != last[record.edits.points[i].number];
  CHECK(wrong == 0);
}

TEST_CASE("a replay device is where the recorded device was, tick by tick, with its limits") {
  std::vector<LoggedTick> ticks;
  for (std::uint64_t i = 0; i < 100; ++i)
    if (i != 50) ticks.push_back(tickAt(i));
  ReplayDevice device(ticks, {.peakForce_N = 1.5, .handHeld = true});
  CHECK(device.limits().peakForce_N == 1.5);
  for (std::uint64_t i = 0; i < 100; ++i) {
    const double time_s = static_cast<double>(i) / 1000;
    CHECK(device.read(time_s).position == tickAt(i == 50 ? 49 : i).device);
  }
  CHECK(device.read(-1).position == tickAt(0).device);
  CHECK(device.read(9).position == tickAt(99).device);
}

}  // namespace palpate::session_log_test
