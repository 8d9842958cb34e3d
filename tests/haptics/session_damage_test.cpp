// Reading a truncated or damaged log; it reports what is missing.
#include <random>

#include "engine/core/checksum.hpp"
#include "engine/core/counted.hpp"
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

TEST_CASE("the ticks of a log stand beside their edits, also of a session whose ticks come all at once") {
  const ScratchFolder folder;
  {
    SessionWriter writer(folder / "log", "a text");
    for (std::uint32_t i = 0; i < 700; ++i) {
      writer.add(tickAt(i));
      writer.add(editsAt(i));
    }
    writer.finish(77);
  }
  const std::string whole = contentOf(folder / "log");
  for (const double share : {0.3, 0.5, 0.75, 0.9}) {
    CAPTURE(share);
    write(folder / "cut", whole.substr(0, static_cast<std::size_t>(share * static_cast<double>(whole.size()))));
    const SessionRecord record = readSessionLog(folder / "cut");
    checkBeginning(record);
    CHECK(static_cast<double>(record.ticks.size()) > 700 * (share - 0.15));
    CHECK(record.edits.points.size() <= 3 * record.ticks.size() + 300);  // a block
  }
  // Damage of a block of edits leaves the ticks before it, which replay repeats.
  std::string changed = whole;
  changed[whole.size() / 2] ^= 1;
  write(folder / "changed", changed);
  const SessionRecord record = readSessionLog(folder / "changed");
  REQUIRE(record.gaps.size() == 1);
  CHECK(record.gaps[0].tick > 200);
}

TEST_CASE("a log whose end the disk has filled with zeros is truncated, not damaged") {
  const ScratchFolder folder;
  writeSession(folder / "log", 700);
  const std::string whole = contentOf(folder / "log");
  for (const double share : {0.3, 0.7, 0.95}) {
    std::string blank = whole;
    const auto from = static_cast<std::size_t>(share * static_cast<double>(whole.size()));
    blank.replace(from, std::string::npos, whole.size() - from, '\0');
    write(folder / "blank", blank);
    const SessionRecord record = readSessionLog(folder / "blank");
    checkBeginning(record);
    CHECK(static_cast<double>(record.ticks.size()) > 700 * (share - 0.2));
    CHECK(saysOneOf(whatIsMissing(record), "it is truncated at byte"));
    CHECK_FALSE(saysOneOf(whatIsMissing(record), "damaged"));
  }
}

TEST_CASE("a changed byte costs its block, which is reported; one in a header costs nothing") {
  const ScratchFolder folder;
  writeSession(folder / "log", 700);
  const std::string whole = contentOf(folder / "log");
  const std::size_t headersEnd = 2 * (32 + 8);
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
      CHECK(saysOneOf(whatIsMissing(record),
                      fmt::format("bytes {} to {} of {} are damaged: {} and {} of points", gap.begin, gap.end,
                                  whole.size(), counted(*gap.ticks, "tick"), counted(*gap.states, "edit"))));
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
    const std::size_t at = 64 + random() % (whole.size() - 40'000), bytes = 1 + random() % 5000;
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
  CHECK(record.edits.points[record.countedEdits - 1].number == record.countedEdits - 1);
}

TEST_CASE("a log of an older version is refused with both versions") {
  const ScratchFolder folder;
  const session_file::Header header{.version = 2, .textBytes = 8};
  std::string text(sizeof header, 0);
  std::memcpy(text.data(), &header, sizeof header);
  write(folder / "log", text + "a text  ");
  CHECK_THROWS_WITH_AS(readSessionLog(folder / "log"),
                       doctest::Contains("is a session log of version 2, and this palpate reads versions 5 to 7"),
                       FileError);
}

}  // namespace palpate::session_damage_test
