// Reading a truncated or damaged log; it reports what is missing.
#include <atomic>
#include <csignal>
#include <functional>
#include <random>

#include "engine/core/checksum.hpp"
#include "engine/core/error.hpp"
#include "tests/haptics/logged_session.hpp"

namespace palpate::session_damage_test {

TEST_CASE("a log truncated anywhere is read up to its last whole block") {
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
    // Complete blocks stay readable after the rest is cut off.
    write(folder / "cut", whole.substr(0, record.wholeBytes));
    CHECK(readSessionLog(folder / "cut").ticks.size() == record.ticks.size());
  }
  CHECK(most > 500);
}

TEST_CASE("a changed byte costs its block, which is reported; one in a header costs nothing") {
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
    } else {  // it was the last block, which contains the session's end
      CHECK(record.ticks.size() == 700);
      CHECK(record.edits.points.size() == 3 * 700);
      CHECK(saysOneOf(whatIsMissing(record), "truncated at byte"));
    }
  }
  CHECK(ends > 150);
}

TEST_CASE("deleted, inserted or blank bytes cost no more than the blocks they touch") {
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

TEST_CASE("several gaps are reported one by one, and only the ticks before the first count edits") {
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

// A log in the format of version 2: one header, blocks of ticks and edits together.
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

TEST_CASE("a log of version 2 is read, and a changed byte costs only its block") {
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
    CHECK(saysOneOf(whatIsMissing(record), record.end ? "are damaged: ticks and edits" : "truncated at byte"));
  }
  std::string changed = whole;
  changed[20] ^= 1;  // the only header
  write(folder / "changed", changed);
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "changed"), doctest::Contains("header"), FileError);
}

}  // namespace palpate::session_damage_test
