// COPC: the octree's pages are traversed, all points are read, and invalid entries are refused.
#include "engine/io/copc.hpp"

#include <doctest/doctest.h>

#include "tests/io/copc_bytes.hpp"
#include "tests/io/damage.hpp"

namespace palpate::test::copc_test {

TEST_CASE("all points of a COPC octree are read in file order, and the lost octree is reported") {
  const CopcFile file = copcFile();
  const StoredCloud stored = reading(file.text);
  CHECK(stored.cloud.size() == 900);
  CHECK(stored.lost == std::vector<std::string>{"the octree of COPC: 3 nodes on 3 levels"});
  const std::string back = written(stored.cloud);
  CHECK(pointsOf(back).substr(0, file.rows.size()) == file.rows);
  CHECK(back.ends_with("stays"));
  CHECK(back.find("copc") == back.npos);
  CHECK(stored.cloud.storedAs.baggage->sentence == "1 record of LAS: 'late' 3");
  const ScratchFolder folder;
  std::ofstream(folder / "a.copc.laz", std::ios::binary) << file.text;
  CHECK(cloudFormats().toRead(folder / "a.copc.laz").name == "COPC");
  CHECK(contentsOf(folder / "a.copc.laz").elements.at(0).count == 900);
}

TEST_CASE("a COPC hierarchy with cycles or entries outside the file is refused with its byte") {
  const CopcFile good = copcFile();
  const auto with = [&](std::size_t at, const CopcNode& node, const std::string& expected) {
    CopcFile file = good;
    file.put(at, node);
    refuses("a.las", file.text, expected);
  };
  const auto say = [](std::size_t at, const char* what) { return fmt::format(": byte {}: {}...", at, what); };
  const std::size_t root = good.root, page = good.page;
  refuses("a.las", good.text, "read");
  with(page, {{1, 0, 1, 0}, root, 64, -1}, say(page + 16, "the page of the hierarchy at byte"));
  with(page, {{1, 0, 1, 0}, page, 64, -1}, "...is referenced twice...");
  with(root + 32, {{1, 0, 1, 0}, 1u << 30, 64, -1}, say(root + 48, "a page of 64 bytes"));
  with(root + 32, {{1, 0, 1, 0}, page, 33, -1}, say(root + 48, "a page of 33 bytes"));
  with(root + 32, {{1, 0, 1, 0}, page, -32, -1}, say(root + 48, "a page of 0 bytes"));
  with(page, {{1, 2, 1, 0}, 0, 0, 0}, say(page, "a node 1-2-1-0, which is not in an octree"));
  with(page, {{-1, 0, 0, 0}, 0, 0, 0}, say(page, "a node -1-0-0-0"));
  with(page, {{31, 0, 0, 0}, 0, 0, 0}, say(page, "a node 31-0-0-0"));
  with(page, {{1, 0, 1, 0}, root, 10, -2}, say(page + 24, "a node of -2 points"));
  with(page, {{1, 0, 1, 0}, root, 10, 0}, say(page + 24, "a node of 0 points in 10 bytes"));
  with(page, {{1, 0, 1, 0}, 100, 10, 5}, say(page + 16, "a node at byte 100, outside the points"));
  with(page, {{1, 0, 1, 0}, std::uint64_t{1} << 63, 10, 5}, "...outside the points...");
  with(page, {{0, 0, 0, 0}, 0, 0, 0}, "...the node 0-0-0-0 is a duplicate...");
  with(page, {{1, 0, 1, 0}, 0, 0, 0}, say(good.info + 40, "the nodes of the hierarchy have 800"));
  std::uint64_t first = 0;
  std::memcpy(&first, good.text.data() + root + 16, sizeof first);
  with(page, {{1, 0, 1, 0}, first + 5, 200, 100}, "...overlap...");
  CopcFile far = good;
  putAt(far.text, far.info + 40, std::uint64_t{1} << 50);
  refuses("a.las", far.text, say(far.info + 40, "a page of 64 bytes of the hierarchy"));
}

TEST_CASE("damaged COPC files are read or refused, without a crash") {
  const CopcFile file = copcFile();
  constexpr int kTries = 500;
  checkDamaged(file.text, ".laz", file.info + 160, kTries, {20, kTries - 20});
  // The pages follow the points; damaged alone, they are damaged more often.
  Damage damage;
  for (int k = 0; k < kTries; ++k) {
    const std::string pages = damage.of(file.text.substr(file.root, 4 * CopcFile::kEntry), 4 * CopcFile::kEntry);
    std::string text = file.text;
    text.replace(file.root, pages.size(), pages);
    const std::string why = refusalOf("a.las", text);
    CHECK((why == "read" || why.starts_with(": byte ")));
  }
}

}  // namespace palpate::test::copc_test
