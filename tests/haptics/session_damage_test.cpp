// What is read of a log that was cut off, damaged, killed, or met a full disk; and that it says what is missing.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <functional>
#include <random>

#include "engine/core/checksum.hpp"
#include "engine/core/error.hpp"
#include "tests/haptics/logged_session.hpp"

namespace palpate {

TEST_CASE("cut off anywhere, a log is read up to its last whole block") {
  const ScratchFolder folder;
  writeSession(folder / "log", 700);
  const std::string whole = contentOf(folder / "log");
  std::mt19937 random(1);
  std::size_t most = 0;
  for (int i = 0; i < 200; ++i) {
    const std::size_t size = 64 + random() % (whole.size() - 64);
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

TEST_CASE("a byte that changed costs the block that it is in, and that is said; one in a header costs nothing") {
  const ScratchFolder folder;
  writeSession(folder / "log", 700);
  const std::string whole = contentOf(folder / "log");
  const std::size_t headersEnd = 2 * (24 + 8);
  std::mt19937 random(2);
  std::size_t ends = 0;
  for (int i = 0; i < 300; ++i) {
    const std::size_t at = i < 80 ? static_cast<std::size_t>(i) : random() % whole.size();
    CAPTURE(at);
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ (1 + random() % 255));
    write(folder / "changed", changed);
    const SessionRecord record = readSessionLog(folder / "changed");
    checkPieces(record);
    CHECK(record.text.starts_with("a text"));
    if (at < headersEnd) {
      CHECK(record.gaps.empty());
      CHECK(record.ticks.size() == 700);
      continue;
    }
    REQUIRE(record.gaps.size() == 1);
    const LogGap& gap = record.gaps[0];
    CHECK(gap.begin <= at);
    CHECK(at < gap.end);
    CHECK(gap.end - gap.begin < 20'000);
    CHECK(whatIsMissing(record).size() == 1);
    if (record.end) {
      ++ends;
      REQUIRE(gap.ticks);
      CHECK(record.ticks.size() + *gap.ticks == 700);
      CHECK(record.edits.points.size() + *gap.states == 3 * 700);
      CHECK(*gap.ticks + *gap.states > 0);
      CHECK(saysOneOf(whatIsMissing(record), fmt::format("bytes {} to {} of {} are damaged: {} ticks and {} edits",
                                                         gap.begin, gap.end, whole.size(), *gap.ticks, *gap.states)));
    } else {  // it was the last one, which says how the session ended
      CHECK(record.ticks.size() == 700);
      CHECK(record.edits.points.size() == 3 * 700);
      CHECK(saysOneOf(whatIsMissing(record), "torn at byte"));
    }
  }
  CHECK(ends > 150);
}

TEST_CASE("what is cut out, put in, or blank in the middle costs no more than the blocks that it touches") {
  const ScratchFolder folder;
  writeSession(folder / "log", 2000);
  const std::string whole = contentOf(folder / "log");
  std::mt19937 random(4);
  for (int i = 0; i < 100; ++i) {
    const std::size_t at = 64 + random() % (whole.size() - 10'000), bytes = 1 + random() % 5000;
    CAPTURE(at);
    CAPTURE(bytes);
    std::string changed = whole;
    if (i % 3 == 0) changed.erase(at, bytes);
    if (i % 3 == 1) changed.insert(at, std::string(bytes, 'b'));
    if (i % 3 == 2) changed.replace(at, bytes, bytes, '\0');
    write(folder / "changed", changed);
    const SessionRecord record = readSessionLog(folder / "changed");
    checkPieces(record);
    REQUIRE(record.end);
    CHECK(record.gaps.size() == 1);
    CHECK(record.ticks.size() + missing(record, &LogGap::ticks) == 2000);
    CHECK(record.edits.points.size() + missing(record, &LogGap::states) == 3 * 2000);
    CHECK(record.ticks.size() > 1600);
    CHECK(record.edits.points.size() > 4000);
    CHECK(record.countedEdits < 3 * 2000);
  }
}

TEST_CASE("several gaps are told one by one, and only the ticks before the first count edits") {
  const ScratchFolder folder;
  writeSession(folder / "log", 2000);
  std::string changed = contentOf(folder / "log");
  for (const std::size_t part : {4u, 2u}) changed[changed.size() / part] ^= 1;
  write(folder / "changed", changed);
  const SessionRecord record = readSessionLog(folder / "changed");
  checkPieces(record);
  REQUIRE(record.gaps.size() == 2);
  CHECK(record.gaps[0].end < record.gaps[1].begin);
  CHECK(record.gaps[0].tick < record.gaps[1].tick);
  CHECK(record.ticks.size() + missing(record, &LogGap::ticks) == 2000);
  CHECK(whatIsMissing(record).size() == 2);
  REQUIRE(record.countedEdits > 0);
  REQUIRE(record.countedEdits < record.edits.points.size());
  CHECK(record.edits.points[record.countedEdits - 1].number() == record.countedEdits - 1);
}

namespace {

// A log as version 2 wrote it: one header, blocks of ticks and edits together.
void writeVersion2(const std::filesystem::path& file, std::uint32_t blocks) {
  std::ofstream out(file, std::ios::binary);
  const auto put = [&](const auto& bytes) {
    out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  };
  const std::string text = "a text  ";
  Checksum textSum;
  textSum.add(std::as_bytes(std::span(text)));
  const session_file::Header header{.version = 2, .textBytes = 8, .checksum = textSum.value()};
  put(std::as_bytes(std::span(&header, 1)));
  put(std::as_bytes(std::span(text)));
  for (std::uint32_t number = 0; number < blocks; ++number) {
    std::vector<LoggedTick> ticks;
    EditBatch edits;
    std::vector<session_file::Mark> marks;
    for (std::uint32_t i = 100 * number; i < 100 * (number + 1); ++i) {
      ticks.push_back(tickAt(i));
      const EditBatch more = editsAt(i);
      edits.points.insert(edits.points.end(), more.points.begin(), more.points.end());
      if (!more.marks.empty()) marks.push_back({edits.points.size(), 0});
    }
    session_file::Block block{.number = number,
                              .ticks = 100,
                              .states = 300,
                              .marks = static_cast<std::uint32_t>(marks.size()),
                              .last = number + 1 == blocks,
                              .end = {.points = number + 1 == blocks ? 77u : 0u}};
    Checksum sum;
    sum.addValue(block);
    sum.add(std::as_bytes(std::span(ticks)));
    sum.add(std::as_bytes(std::span(edits.points)));
    sum.add(std::as_bytes(std::span(marks)));
    block.checksum = sum.value();
    put(std::as_bytes(std::span(&block, 1)));
    put(std::as_bytes(std::span(ticks)));
    put(std::as_bytes(std::span(edits.points)));
    put(std::as_bytes(std::span(marks)));
  }
}

}  // namespace

TEST_CASE("a log of version 2 is read, and a byte that changed costs its block there too") {
  const ScratchFolder folder;
  writeVersion2(folder / "log", 7);
  const SessionRecord old = readSessionLog(folder / "log");
  checkBeginning(old);
  CHECK(old.text == "a text  ");
  CHECK(old.ticks.size() == 700);
  CHECK(old.edits.points.size() == 2100);
  CHECK(old.edits.marks.size() == 70);
  CHECK(old.gaps.empty());
  REQUIRE(old.end);
  CHECK(old.end->points == 77);

  const std::string whole = contentOf(folder / "log");
  std::mt19937 random(5);
  for (int i = 0; i < 100; ++i) {
    const std::size_t at = 32 + random() % (whole.size() - 32);
    CAPTURE(at);
    std::string changed = whole;
    changed[at] = static_cast<char>(changed[at] ^ (1 + random() % 255));
    write(folder / "changed", changed);
    const SessionRecord record = readSessionLog(folder / "changed");
    checkPieces(record);
    CHECK(record.ticks.size() == 600);
    CHECK(record.edits.points.size() == 1800);
    REQUIRE(record.gaps.size() == 1);
    CHECK_FALSE(record.gaps[0].ticks);
    CHECK(saysOneOf(whatIsMissing(record), record.end ? "are damaged: ticks and edits" : "torn at byte"));
  }
  std::string changed = whole;
  changed[20] ^= 1;  // the only header there is
  write(folder / "changed", changed);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "changed"), doctest::Contains("header"), FileError);
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
  CHECK(record.edits.points.size() > 900);
  CHECK(
      saysOneOf(whatIsMissing(record), fmt::format("what came after {:.3f} s is missing", record.ticks.back().time_s)));
}

namespace {

// What `act` gives in a process whose files may have `limit` bytes.
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

// A session of `ticks`, edits with each, on a disk with room for `limit` bytes; from tick `freed` on there is more.
// Gives how often the writer told that it could not write, and 20 more where the end said nothing of it.
int writeOnFullDisk(const std::filesystem::path& file, rlim_t limit, std::uint32_t ticks, std::uint32_t freed) {
  return inProcessWithSmallFiles(limit, [&] {
    std::atomic<int> told = 0;
    SessionWriter writer(file, "a text", [&](const std::string& sentence) {
      told += sentence.find("free some space") != std::string::npos && sentence.find(file.string()) == 0 ? 1 : 10;
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

TEST_CASE("on a full disk the session goes on, is told once, and what fits is in the log: ticks, edits and its end") {
  const ScratchFolder folder;
  constexpr std::uint32_t kTicks = 5000;
  CHECK(writeOnFullDisk(folder / "log", 614'400, kTicks, kTicks) == 1);
  const SessionRecord record = readSessionLog(folder / "log");
  checkPieces(record);
  CHECK(record.fileBytes <= 614'400);
  CHECK(record.wholeBytes == record.fileBytes);
  CHECK(record.wholeBytes > 590'000);  // a block less at most
  CHECK(record.ticks.size() > 2300);   // of 2,600 that fit at all, with three edits each
  CHECK(record.edits.points.size() > 2300 * 3);
  REQUIRE(record.end);  // for which there was room once the torn block was gone
  CHECK(record.ticks.size() + missing(record, &LogGap::ticks) == kTicks);
  CHECK(record.edits.points.size() + missing(record, &LogGap::states) == 3 * kTicks);
  CHECK(saysOneOf(whatIsMissing(record), "they were not written"));
}

TEST_CASE("of many edits that come at once a full disk leaves all but the last block that fits") {
  const ScratchFolder folder;
  constexpr std::uint32_t kEdits = 100'000;
  const int told = inProcessWithSmallFiles(614'400, [&] {
    SessionWriter writer(folder / "log", "a text");
    EditBatch all;
    for (std::uint32_t i = 0; i < kEdits; ++i) all.points.push_back({.id = i});
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
  REQUIRE(record.edits.points.size() > 16'000);  // of 17,000 that there is room for
  CHECK(record.edits.points.back().number() == record.edits.points.size() - 1);
  CHECK(record.ticks.size() == 1);
  CHECK(missing(record, &LogGap::states) == kEdits - record.edits.points.size());
}

TEST_CASE("once there is room again the log goes on, and says what it has not") {
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

TEST_CASE("a header for which there is no room is an error, and no log") {
  const ScratchFolder folder;
  if (!std::filesystem::exists("/dev/full")) {
    MESSAGE("skipped: there is no /dev/full");
    return;
  }
  CHECK_THROWS_WITH_AS(SessionWriter("/dev/full", "a text"), doctest::Contains("free some space"), FileError);
}

}  // namespace palpate
