#include "haptics/session_log.hpp"

#include <random>

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
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"), doctest::Contains("version 9"), FileError);
  for (const std::size_t header : {0u, 40u}) newer[header + 8] = 4;
  write(folder / "bad", newer);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"),
                       doctest::Contains("bad: is a session log of version 4, and this palpate reads version 5"),
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
