// Reading a log after a kill or a full disk; it reports what is missing.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <functional>

#include "engine/core/error.hpp"
#include "tests/haptics/logged_session.hpp"

namespace palpate::session_damage_test {

TEST_CASE("a killed process keeps all but the last moments of its session") {
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
  CHECK(record.edits.points.size() > 900);
  CHECK(saysOneOf(whatIsMissing(record),
                  fmt::format("everything after {:.3f} s is missing", record.ticks.back().time_s)));
}

namespace {

// Result of `act` in a process whose files are limited to `limit` bytes.
int inProcessWithSmallFiles(rlim_t limit, const std::function<int()>& act) {
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    rlimit allowed{};
    ::getrlimit(RLIMIT_FSIZE, &allowed);
    allowed.rlim_cur = limit;
    ::setrlimit(RLIMIT_FSIZE, &allowed);
    ::_exit(act());
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  REQUIRE(WIFEXITED(status));
  return WEXITSTATUS(status);
}

void makeRoom() {
  rlimit allowed{};
  ::getrlimit(RLIMIT_FSIZE, &allowed);
  allowed.rlim_cur = allowed.rlim_max;
  ::setrlimit(RLIMIT_FSIZE, &allowed);
}

// A session of `ticks` with edits in each, on a disk with room for `limit` bytes; more from tick `freed` on. Returns
// how often the writer reported a write error, plus 20 if the end does not report it.
int writeOnFullDisk(const std::filesystem::path& file, rlim_t limit, std::uint32_t ticks, std::uint32_t freed) {
  return inProcessWithSmallFiles(limit, [&] {
    std::atomic<int> told = 0;
    SessionWriter writer(file, "a text", [&](const std::string& sentence) {
      told += sentence.find("limit of file sizes") != std::string::npos && sentence.find(file.string()) == 0 ? 1 : 10;
    });
    for (std::uint32_t i = 0; i < ticks; ++i) {
      if (i == freed) makeRoom();
      writer.add(tickAt(i));
      writer.add(editsAt(i));
      if (i % 100 == 99) writer.flush();
    }
    try {
      writer.finish(77);
      told += 20;
    } catch (const FileError& error) {
      if (std::string(error.what()).find("are missing in it") == std::string::npos) told += 20;
    }
    return told.load();
  });
}

}  // namespace

TEST_CASE("on a full disk the session continues, gets one error, and the log holds the ticks, edits and end that fit") {
  const ScratchFolder folder;
  constexpr std::uint32_t kTicks = 5000;
  CHECK(writeOnFullDisk(folder / "log", 614'400, kTicks, kTicks) == 1);
  const SessionRecord record = readSessionLog(folder / "log");
  checkPieces(record);
  CHECK(record.fileBytes <= 614'400);
  CHECK(record.wholeBytes == record.fileBytes);
  CHECK(record.wholeBytes > 590'000);  // at most a block less
  CHECK(record.ticks.size() > 1900);   // each has three edits
  CHECK(record.edits.points.size() > 1900 * 3);
  REQUIRE(record.end);  // it fits after the torn block was removed
  CHECK(record.ticks.size() + missing(record, &LogGap::ticks) == kTicks);
  CHECK(record.edits.points.size() + missing(record, &LogGap::states) == 3 * kTicks);
  CHECK(saysOneOf(whatIsMissing(record), "they were not written"));
}

TEST_CASE("a full disk keeps all but the last block that fits of many edits at once") {
  const ScratchFolder folder;
  constexpr std::uint32_t kEdits = 100'000;
  const int told = inProcessWithSmallFiles(614'400, [&] {
    SessionWriter writer(folder / "log", "a text");
    EditBatch all;
    for (std::uint32_t i = 0; i < kEdits; ++i) all.points.push_back({.number = i});
    writer.add(all);
    writer.add(tickAt(0));
    try {
      writer.finish(77);
      return 0;
    } catch (const FileError&) {
      return 1;
    }
  });
  CHECK(told == 1);
  const SessionRecord record = readSessionLog(folder / "log");
  REQUIRE(record.edits.points.size() > 10'300);  // of 10,900 that fit
  CHECK(record.edits.points.back().number == record.edits.points.size() - 1);
  CHECK(record.ticks.size() == 1);
  CHECK(missing(record, &LogGap::states) == kEdits - record.edits.points.size());
}

TEST_CASE("a full disk keeps the changes of fields that fit, and the log counts the others") {
  const ScratchFolder folder;
  constexpr std::uint32_t kChanges = 100;
  const int told = inProcessWithSmallFiles(614'400, [&] {
    SessionWriter writer(folder / "log", "a text");
    for (std::uint32_t i = 0; i < kChanges; ++i) {
      writer.add(EditBatch{.marks = {{0, EditMark::Kind::attribute}}, .attributes = {changeOf(i, 10'001)}});
      writer.flush();
    }
    try {
      writer.finish(77);
      return 0;
    } catch (const FileError& error) {
      return std::string(error.what()).find("commands and 0 edits of points are missing in it") != std::string::npos
                 ? 1
                 : 0;
    }
  });
  CHECK(told == 1);
  const SessionRecord record = readSessionLog(folder / "log");
  REQUIRE(record.end);
  const std::size_t count = record.edits.attributes.size();
  CHECK(count > 50);
  CHECK(record.edits.marks.size() == count);
  for (std::uint32_t i = 0; i < count; ++i) CHECK(record.edits.attributes[i] == changeOf(i, 10'001));
  CHECK(count + missing(record, &LogGap::commands) == kChanges);
}

TEST_CASE("a log continues once the disk has space again, and states what is missing") {
  const ScratchFolder folder;
  CHECK(writeOnFullDisk(folder / "log", 100'000, 2000, 1000) == 1);
  const SessionRecord record = readSessionLog(folder / "log");
  checkPieces(record);
  REQUIRE(record.end);
  REQUIRE(!record.ticks.empty());
  CHECK(record.ticks.back().time_s == tickAt(1999).time_s);
  CHECK(record.ticks.size() + missing(record, &LogGap::ticks) == 2000);
  CHECK(missing(record, &LogGap::ticks) > 300);
  std::size_t later = 0;
  for (const LoggedTick& tick : record.ticks) later += tick.time_s >= 1;
  CHECK(later == 1000);
}

TEST_CASE("a header that does not fit on the disk is an error, and leaves no log") {
  const ScratchFolder folder;
  if (!std::filesystem::exists("/dev/full")) {
    MESSAGE("skipped: this machine has no /dev/full");
    return;
  }
  CHECK_THROWS_WITH_AS(SessionWriter("/dev/full", "a text"), doctest::Contains("free some space"), FileError);
}

}  // namespace palpate::session_damage_test
