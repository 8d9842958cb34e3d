#include "haptics/session_log.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <fstream>
#include <random>
#include <sstream>
#include <thread>

#include "engine/core/error.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/session_writer.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate {

namespace {

LoggedTick tickAt(std::uint64_t i) {
  const auto x = static_cast<double>(i);
  return {.time_s = x / 1000,
          .device = {x, -x, 0.1 * x},
          .proxy = {x, 1, 2},
          .force_N = {0, 0, 1 / (1 + x)},
          .edits = 3 * i,
          .neighbours = static_cast<std::uint32_t>(i % 50),
          .flags = static_cast<std::uint32_t>(i % 8)};
}

EditBatch editsAt(std::uint32_t i) {
  EditBatch batch;
  for (std::uint32_t k = 0; k < 3; ++k) batch.points.push_back({.position = {1, 2, 3}, .id = 3 * i + k, .parent = k});
  if (i % 10 == 9) batch.marks.push_back({3, EditMark::Kind::stroke});
  return batch;
}

void writeSession(const std::filesystem::path& file, std::uint32_t ticks, bool ends = true) {
  SessionWriter writer(file, "a text");
  for (std::uint32_t i = 0; i < ticks; ++i) {
    writer.add(tickAt(i));
    writer.add(editsAt(i));
    if (i % 100 == 99) writer.flush();
  }
  if (ends) writer.finish(77);
}

bool sameTick(const LoggedTick& a, const LoggedTick& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

// That what was read is a beginning of writeSession()'s.
void checkBeginning(const SessionRecord& record) {
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < record.ticks.size(); ++i) wrong += !sameTick(record.ticks[i], tickAt(i));
  for (std::size_t i = 0; i < record.edits.points.size(); ++i) wrong += record.edits.points[i].number() != i;
  for (std::size_t i = 0; i < record.edits.marks.size(); ++i) wrong += record.edits.marks[i].at != 30 * (i + 1);
  CHECK(wrong == 0);
}

std::string contentOf(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}
void write(const std::filesystem::path& file, const std::string& content) {
  std::ofstream(file, std::ios::binary) << content;
}

}  // namespace

TEST_CASE("a session log is read as it was written") {
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

TEST_CASE("a session of nothing is a whole log too, and one that was not finished has no end") {
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

TEST_CASE("cut off anywhere, a log is read up to its last whole block") {
  const ScratchFolder folder;
  writeSession(folder / "log", 700);
  const std::string whole = contentOf(folder / "log");
  std::mt19937 random(1);
  std::size_t most = 0;
  for (int i = 0; i < 200; ++i) {
    const std::size_t size = 32 + random() % (whole.size() - 32);
    CAPTURE(size);
    write(folder / "cut", whole.substr(0, size));
    const SessionRecord record = readSessionLog(folder / "cut");
    checkBeginning(record);
    CHECK_FALSE(record.end);
    CHECK(record.fileBytes == size);
    CHECK(record.wholeBytes <= size);
    most = std::max(most, record.ticks.size());
    // What is whole stays whole when the rest goes.
    write(folder / "cut", whole.substr(0, record.wholeBytes));
    CHECK(readSessionLog(folder / "cut").ticks.size() == record.ticks.size());
  }
  CHECK(most > 500);
}

TEST_CASE("a byte that changed anywhere ends the record before it, or is an error in the header") {
  const ScratchFolder folder;
  writeSession(folder / "log", 700);
  const std::string whole = contentOf(folder / "log");
  const std::size_t headerEnd = 24 + 8;
  std::mt19937 random(2);
  for (int i = 0; i < 200; ++i) {
    const std::size_t at = i < 40 ? static_cast<std::size_t>(i) : random() % whole.size();
    CAPTURE(at);
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ (1 + random() % 255));
    write(folder / "changed", changed);
    if (at < headerEnd) {
      CHECK_THROWS_AS(readSessionLog(folder / "changed"), FileError);
    } else {
      const SessionRecord record = readSessionLog(folder / "changed");
      checkBeginning(record);
      CHECK(record.wholeBytes <= at);
      CHECK_FALSE(record.end);
    }
  }
}

TEST_CASE("what is no log, is missing, or is of another version is an error that says so") {
  const ScratchFolder folder;
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "none"), doctest::Contains("cannot be opened"), FileError);
  for (const std::string& content : {std::string(), std::string("ply\n"), std::string(1000, 'x')}) {
    write(folder / "bad", content);
    CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"), doctest::Contains("no session log"), FileError);
  }
  writeSession(folder / "log", 10);
  std::string newer = contentOf(folder / "log");
  newer[8] = 9;
  write(folder / "bad", newer);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"), doctest::Contains("version 9"), FileError);
  std::string huge = contentOf(folder / "log");
  std::memset(huge.data() + 12, 0xFF, 4);
  write(folder / "bad", huge);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "bad"), doctest::Contains("damaged"), FileError);
  CHECK_THROWS_AS(SessionWriter(folder / "no" / "where", ""), FileError);
}

TEST_CASE("adding a tick waits for nobody: what comes faster than it can be written is lost and counted") {
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

TEST_CASE("edits that come faster than the disk takes them are merged, and give the same points") {
  const ScratchFolder folder;
  constexpr std::uint32_t kPoints = 5000;
  std::vector<std::uint32_t> last(kPoints);
  std::uint64_t told = 0;
  SessionWriter writer(folder / "log", "");
  std::mt19937 random(3);
  // Handed over in one go, so that no disk is fast enough.
  EditBatch all;
  for (std::uint32_t stroke = 1; stroke <= 3; ++stroke) {
    for (int i = 0; i < 1'000'000; ++i) {
      const auto id = static_cast<std::uint32_t>(random() % kPoints);
      all.points.push_back({.id = id, .color = last[id] = ++told % 1'000'003});
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
    wrong += record.edits.points[i].color != last[record.edits.points[i].number()];
  CHECK(wrong == 0);
}

TEST_CASE("a killed process leaves all but the last moments of its session") {
  const ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    SessionWriter writer(folder / "log", "a text");
    for (std::uint32_t i = 0;; ++i) {
      writer.add(tickAt(i));
      writer.add(editsAt(i));
      ::usleep(1000);
    }
  }
  // Until enough of it is on the disk, however slow the machine is.
  constexpr std::uintmax_t kEnough = 200'000;
  std::error_code none;
  for (int i = 0; i < 60'000; ++i) {
    const auto size = std::filesystem::file_size(folder / "log", none);
    if (!none && size > kEnough) break;
    ::usleep(1000);
  }
  ::kill(child, SIGKILL);
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFSIGNALED(status));
  const SessionRecord record = readSessionLog(folder / "log");
  checkBeginning(record);
  CHECK_FALSE(record.end);
  CHECK(record.ticks.size() > 300);
}

TEST_CASE("a full disk ends the log, not the session, and is told in the end") {
  const ScratchFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit tiny{20'000, 20'000};
    ::setrlimit(RLIMIT_FSIZE, &tiny);
    SessionWriter writer(folder / "log", "a text");
    for (std::uint32_t i = 0; i < 2000; ++i) {
      writer.add(tickAt(i));
      if (i % 100 == 99) writer.flush();
    }
    try {
      writer.finish(0);
    } catch (const FileError& error) {
      ::_exit(std::string(error.what()).find("free some space") != std::string::npos ? 0 : 2);
    }
    ::_exit(3);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  const SessionRecord record = readSessionLog(folder / "log");
  checkBeginning(record);
  CHECK(record.ticks.size() >= 100);
  CHECK(record.wholeBytes <= 20'000);
}

TEST_CASE("a replay device is where the recorded one was, tick by tick, with its limits") {
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

}  // namespace palpate
