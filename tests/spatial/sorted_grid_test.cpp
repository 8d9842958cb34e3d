// An index that follows edits: random changes against a fresh build, for 400 steps or for a given time:
// PALPATE_EDITS_S=3600
#include "engine/spatial/sorted_grid.hpp"

#include <doctest/doctest.h>

#include <cstdlib>
#include <random>

#include "engine/core/clock.hpp"
#include "tests/labels.hpp"

namespace palpate::sorted_grid_test {

namespace {

using Numbers = std::vector<std::uint32_t>;

// Points that change at random, and the numbers of those that have changed since the last time.
class ChangingPoints {
 public:
  ChangingPoints(std::size_t count, std::uint32_t seed) : random_(seed) {
    for (std::size_t i = 0; i < count; ++i) append(somewhere());
    changed_.clear();
  }

  const std::vector<Vec3>& positions() const { return positions_; }
  const std::vector<std::uint8_t>& there() const { return there_; }
  const Numbers& changed() const { return changed_; }

  void change() {
    changed_.clear();
    const std::uint32_t kind = pick(40);
    if (kind == 0) return setAll([&](std::uint32_t) { return crowd_; });  // all in one bucket
    if (kind == 1) return setAll([&](std::uint32_t) { return somewhere(); });
    if (kind == 2) return removeAll();
    if (kind < 5) crowd_ = somewhere();
    const std::uint32_t count = pick(4) == 0 ? pick(400) : pick(20);
    for (std::uint32_t i = 0; i < count; ++i) one();
    std::ranges::sort(changed_);
    const auto again = std::ranges::unique(changed_);
    changed_.erase(again.begin(), again.end());
  }
  Vec3 somewhere() { return {10 * share(), 10 * share(), share()}; }

 private:
  std::uint32_t pick(std::uint32_t n) { return std::uniform_int_distribution<std::uint32_t>(0, n - 1)(random_); }
  float share() { return std::uniform_real_distribution<float>(-1, 1)(random_); }
  void append(const Vec3& place) {
    changed_.push_back(static_cast<std::uint32_t>(positions_.size()));
    positions_.push_back(place);
    there_.push_back(1);
  }
  void set(std::uint32_t point, const Vec3& place) {
    changed_.push_back(point);
    positions_[point] = place;
    there_[point] = 1;
  }
  template <class Place>
  void setAll(Place&& place) {
    for (std::uint32_t i = 0; i < positions_.size(); ++i)
      if (there_[i]) set(i, place(i));
  }
  void removeAll() {
    for (std::uint32_t i = 0; i < positions_.size(); ++i)
      if (std::exchange(there_[i], 0)) changed_.push_back(i);
  }
  void one() {
    constexpr std::size_t kMaxPoints = 6000;
    const std::uint32_t kind = pick(10);
    if (positions_.empty() || (kind == 0 && positions_.size() < kMaxPoints)) return append(somewhere());
    if (kind == 1 && positions_.size() < kMaxPoints) return append(crowd_);
    const std::uint32_t point = pick(static_cast<std::uint32_t>(positions_.size()));
    if (std::ranges::find(changed_, point) != changed_.end()) return;
    if (kind == 2 && there_[point]) {
      there_[point] = 0;
      return changed_.push_back(point);
    }
    const Vec3 beside = positions_[point] + 0.05f * somewhere();
    const std::array<Vec3, 4> places{somewhere(), crowd_, 1e7f * somewhere(), beside};
    set(point, places[kind < 5 ? kind % 3 : 3]);
  }

  std::mt19937 random_;
  std::vector<Vec3> positions_;
  std::vector<std::uint8_t> there_;
  Numbers changed_;
  Vec3 crowd_{1};
};

bool sameBuckets(const SortedGrid& grid, const SortedGrid& fresh) {
  for (std::uint32_t b = 0; b <= grid.grid().bucketMask; ++b) {
    const auto mine = grid.bucket(b), theirs = fresh.bucket(b);
    const auto same = [](const SortedGrid::Placed& one, const SortedGrid::Placed& other) {
      return one.number == other.number && one.position == other.position;
    };
    if (!std::ranges::equal(mine, theirs, same)) return false;
  }
  return grid.size() == fresh.size();
}

// In the order of the visits.
bool sameAnswers(const SortedGrid& grid, const SortedGrid& fresh, const DVec3& center) {
  for (const double radius : {0.3, 1.0, 4.0, 1e9}) {
    Numbers mine, theirs;
    grid.near(center, radius, mine);
    fresh.near(center, radius, theirs);
    if (mine != theirs) return false;
    mine.clear();
    for (std::size_t slice = 0; slice < grid.slices(center, radius); ++slice)
      grid.forEachNear(center, radius, slice, [&](const SortedGrid::Placed& near) { mine.push_back(near.number); });
    if (mine != theirs) return false;
  }
  return true;
}

// True once `step` steps, or the time that was asked for, are over.
bool isEnough(int step, const Stopwatch& watch) {
  const char* given = std::getenv("PALPATE_EDITS_S");
  return given ? watch.elapsed_s() > std::atof(given) : step >= byTier(400, 20'000);
}

void checkFollows(std::size_t count, unsigned threads, std::uint32_t seed) {
  CAPTURE(count);
  CAPTURE(threads);
  ChangingPoints points(count, seed);
  const HashGrid hash = makeHashGrid(Vec3(-10), 0.7, count);
  SortedGrid grid(hash, threads, SortedGrid::CellTags::on), fresh(hash, 1);
  grid.build(points.positions(), points.there());
  const Stopwatch watch;
  for (int step = 0; !isEnough(step, watch); ++step) {
    CAPTURE(step);
    points.change();
    grid.update(points.positions(), points.there(), points.changed());
    fresh.build(points.positions(), points.there());
    REQUIRE(sameBuckets(grid, fresh));
    REQUIRE(sameAnswers(grid, fresh, DVec3(points.somewhere())));
  }
  CHECK(grid.written() > 0);
}

// Points on a square lattice a unit apart, and a stroke that lowers a patch of 10 by 10 of them to and fro.
struct Plate {
  std::uint32_t side;
  std::vector<Vec3> positions;

  explicit Plate(std::uint32_t points) : side(points) {
    for (std::uint32_t i = 0; i < side * side; ++i)
      positions.emplace_back(static_cast<float>(i % side) + 0.1f, static_cast<float>(i / side) + 0.1f, 0.1f);
  }
  Numbers lower(std::uint32_t x, std::uint32_t y, float by) {
    Numbers moved;
    for (std::uint32_t i = 0; i < 100; ++i) {
      moved.push_back((y + i / 10) * side + x + i % 10);
      positions[moved.back()].z -= by;
    }
    return moved;
  }
};

}  // namespace

TEST_CASE("a position is in its cell and in no other, on its borders and beyond all cells") {
  const HashGrid grid = makeHashGrid(Vec3(-10, 0.3f, 7), 0.7, 1000);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share(-1, 1);
  std::size_t wrong = 0, within = 0;
  const auto check = [&](const Vec3& position) {
    const IVec3 cell = cellOf(grid, position);
    for (int k = 0; k < 27; ++k) {
      const IVec3 other = cell + IVec3(k % 3, k / 3 % 3, k / 9) - 1;
      if (glm::any(glm::greaterThan(glm::abs(other), IVec3(1 << 30)))) continue;
      wrong += isInCell(grid, position, other) != (cell == other);
      within += isInCell(grid, position, other);
    }
  };
  std::size_t positions = 0;
  for (const float scale : {1.0f, 1e3f, 1e6f, 1e8f, 1e12f})
    for (int i = 0; i < 2000; ++i, ++positions) check(scale * Vec3{share(random), share(random), share(random)});
  for (int i = -50; i < 50; ++i) {
    const float border = grid.origin.x + static_cast<float>(i) / grid.inverseCell;
    for (const float x : {std::nextafter(border, -1e9f), border, std::nextafter(border, 1e9f)}) {
      check({x, 1, 1});
      ++positions;
    }
  }
  for (const float far : {-3e38f, 3e38f}) {
    check({far, 1, 1});
    ++positions;
  }
  for (int i = -50; i < 50; ++i, ++positions) {  // exactly on a border, if rounding allows
    const HashGrid whole{.origin = Vec3(0), .inverseCell = 1, .bucketMask = 255, .blockBits = 0};
    const Vec3 at(static_cast<float>(i));
    for (int x = i - 2; x < i + 3; ++x) wrong += isInCell(whole, at, IVec3(x)) != (x == i);
    ++within;
  }
  CHECK(wrong == 0);
  CHECK(within == positions);
}

TEST_CASE("points in random order are scattered, points in the order of their buckets, or cell by cell, are not") {
  std::mt19937 random(11);
  std::vector<Vec3> positions(20'000);
  for (Vec3& p : positions)
    for (int k = 0; k < 3; ++k) p[k] = std::uniform_real_distribution<float>(0, 1)(random);
  const HashGrid grid = makeHashGrid(Vec3(0), 0.1, positions.size());
  CHECK(isScattered(grid, positions));
  std::ranges::sort(positions, {}, [&](const Vec3& p) { return bucketOf(grid, cellOf(grid, p)); });
  CHECK(!isScattered(grid, positions));
  const auto cell = [&](const Vec3& p) { return cellOf(grid, p); };
  std::ranges::sort(positions, [&](const Vec3& a, const Vec3& b) {
    const IVec3 i = cell(a), k = cell(b);
    return std::tie(i.z, i.y, i.x) < std::tie(k.z, k.y, k.x);
  });
  CHECK(!isScattered(grid, positions));
  for (const std::size_t few : {0, 1}) CHECK(!isScattered(grid, std::span(positions).first(few)));
  CHECK(!isScattered(grid, std::vector<Vec3>(5, Vec3(1))));
}

TEST_CASE("after any edits the index has each bucket's points in the order of a fresh build" * kMoreInFull) {
  for (const unsigned threads : {1u, 3u})
    for (const std::size_t count : {0, 1, 3000}) checkFollows(count, threads, 7 + threads);
}

TEST_CASE("the index is as large after a long stroke to and fro as after a short one") {
  Plate plate(100);
  SortedGrid grid(makeHashGrid(Vec3(0), 2, plate.positions.size()), 1);
  grid.build(plate.positions);
  const std::size_t before = grid.bytes();
  std::size_t early = 0;
  for (std::uint32_t pass = 0; pass < 300; ++pass) {
    for (std::uint32_t x = 0; x < 90; x += 3) grid.update(plate.positions, {}, plate.lower(x, 45, pass % 2 ? 2 : -2));
    if (pass == 3) early = grid.bytes();
  }
  CHECK(grid.builds() == 1);
  CHECK(early > before);
  CHECK(grid.bytes() == early);
}

TEST_CASE("an edit writes as many places of the index in a large cloud as in a small one") {
  std::vector<std::uint64_t> written;
  for (const std::uint32_t side : {60u, 600u}) {
    Plate plate(side);
    SortedGrid grid(makeHashGrid(Vec3(0), 2, plate.positions.size()), 1);
    grid.build(plate.positions);
    for (std::uint32_t x = 0; x < 50; ++x) grid.update(plate.positions, {}, plate.lower(x, 20, 0.3f));
    CHECK(grid.builds() == 1);
    written.push_back(grid.written());
  }
  CHECK(written[0] > 50 * 100);
  CHECK(written[1] < 1.5 * static_cast<double>(written[0]));
  CHECK(written[1] < 50 * 100 * 8);
}

TEST_CASE("a block for a crowded bucket does not move the others, and serves again once given back") {
  SpareBlocks<std::uint32_t> blocks;
  const std::uint32_t small = blocks.take(3), large = blocks.take(5000);
  CHECK(blocks.slots(small) >= 3);
  CHECK(blocks.slots(large) >= 5000);
  std::uint32_t* const first = blocks.at(small);
  std::fill_n(blocks.at(large), blocks.slots(large), 7u);
  std::fill_n(first, blocks.slots(small), 5u);
  std::vector<std::uint32_t> more;
  for (std::uint32_t k = 0; k < 2000; ++k) {
    more.push_back(blocks.take(3));
    std::fill_n(blocks.at(more.back()), blocks.slots(more.back()), k + 10);
  }
  CHECK(blocks.at(small) == first);
  CHECK(std::count(first, first + blocks.slots(small), 5u) == blocks.slots(small));
  CHECK(std::count(blocks.at(large), blocks.at(large) + 5000, 7u) == 5000);
  std::uint32_t others = 0;
  for (std::uint32_t k = 0; k < more.size(); ++k) others += *blocks.at(more[k]) != k + 10;
  CHECK(others == 0);
  const std::size_t bytes = blocks.bytes();
  for (const std::uint32_t block : more) blocks.giveBack(block);
  for (std::size_t k = 0; k < more.size(); ++k) blocks.take(3);
  CHECK(blocks.bytes() == bytes);
}

}  // namespace palpate::sorted_grid_test
