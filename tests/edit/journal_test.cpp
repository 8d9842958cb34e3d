#include "engine/edit/journal.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/clock.hpp"

namespace palpate::journal_test {

namespace {

PointCloud coloredCloud(std::size_t count) {
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const auto f = static_cast<float>(i);
    cloud.positions.emplace_back(f, 0.5f * f, -f);
    cloud.normals.emplace_back(0, 0, 1);
    cloud.colors.push_back({static_cast<std::uint8_t>(i), 1, 2, 255});
  }
  return cloud;
}

/// Acts as a back end with random edits: moves, paints, removes, restores, adds.
class Editor {
 public:
  Editor(const PointCloud& cloud, std::uint32_t seed) : points_(statesOf(cloud)), random_(seed) {}

  std::vector<PointState> tick(std::size_t most) {
    std::vector<PointState> states;
    std::vector<bool> named(points_.size() + most);
    for (std::size_t i = random_() % (most + 1); i > 0; --i) {
      const bool adds = random_() % 10 == 0;
      const auto id = static_cast<std::uint32_t>(adds ? points_.size() : random_() % points_.size());
      if (named[id]) continue;
      named[id] = true;
      if (adds) points_.push_back({.id = id, .parent = static_cast<std::uint32_t>(random_() % id)});
      PointState& point = points_[id];
      if (!adds && random_() % 6 == 0) {
        point.id ^= PointState::kGone;
      } else {
        point.position += Vec3(unit_(random_), unit_(random_), unit_(random_));
        point.normal = glm::normalize(Vec3(unit_(random_), unit_(random_), 2));
        point.color = static_cast<std::uint32_t>(random_());
      }
      states.push_back(point);
    }
    return states;
  }
  std::vector<PointState> change(std::span<const PointChange> changes) {
    std::vector<PointState> states;
    for (const PointChange& change : changes) {
      PointState& point = points_[change.to.number()];
      CHECK(point == change.from);
      states.push_back(point = change.to);
    }
    return states;
  }
  const std::vector<PointState>& points() const { return points_; }

 private:
  std::vector<PointState> points_;
  std::mt19937 random_;
  std::uniform_real_distribution<float> unit_{-1, 1};
};

void append(EditBatch& batch, const std::vector<PointState>& states) {
  batch.points.insert(batch.points.end(), states.begin(), states.end());
}
void give(Journal& journal, EditBatch& batch) {
  journal.follow(batch);
  batch.clear();
}
void mark(EditBatch& batch, EditMark::Kind kind) { batch.marks.push_back({batch.points.size(), kind}); }

// Existing points must be equal in every property; for others it is enough that they do not exist.
std::size_t differences(std::span<const PointState> a, std::span<const PointState> b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const bool inA = i < a.size() && !a[i].gone(), inB = i < b.size() && !b[i].gone();
    different += inA != inB || (inA && a[i] != b[i]);
  }
  return different;
}

std::vector<PointState> copyOf(std::span<const PointState> points) { return {points.begin(), points.end()}; }

PointState movedTo(float z, PointState point) {
  point.position.z = z;
  return point;
}

EditBatch strokeOf(std::uint32_t first, std::uint32_t count, float z) {
  EditBatch batch;
  for (std::uint32_t i = first; i < first + count; ++i) batch.points.push_back({.position = {0, 0, z}, .id = i});
  mark(batch, EditMark::Kind::stroke);
  return batch;
}

}  // namespace

TEST_CASE("undo and redo of random strokes of every kind restore each state bit by bit") {
  const PointCloud cloud = coloredCloud(257);
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    CAPTURE(seed);
    Editor editor(cloud, seed);
    Journal journal(cloud, 1 << 30);
    std::mt19937 random(seed + 100);
    std::vector<std::vector<PointState>> states{copyOf(editor.points())};   // after each stroke that is not undone
    std::vector<std::optional<std::uint64_t>> versions{journal.version()};  // where examined
    std::size_t at = 0, walked = 0, metAgain = 0;
    EditBatch batch;
    for (int step = 0; step < 400; ++step) {
      if (random() % 2) {
        bool any = false;
        for (std::size_t tick = 1 + random() % 5; tick > 0; --tick) {
          const auto edited = editor.tick(40);
          any = any || !edited.empty();
          append(batch, edited);
          if (random() % 3 == 0) {  // a reader in the middle of a stroke
            give(journal, batch);
          }
        }
        mark(batch, EditMark::Kind::stroke);
        if (any) {
          states.resize(++at);
          states.push_back(copyOf(editor.points()));
          versions.resize(at);
          versions.emplace_back();
        }
        if (random() % 2) continue;  // sometimes only after several strokes
        give(journal, batch);
      } else {
        give(journal, batch);
        const bool back = random() % 3 != 0;
        const auto changes = back ? journal.undo() : journal.redo();
        if (back ? at > 0 : at + 1 < states.size()) back ? --at : ++at;
        append(batch, editor.change(changes));
        if (!changes.empty()) mark(batch, EditMark::Kind::change);
        give(journal, batch);
        ++walked;
      }
      CHECK_FALSE(journal.inStroke());
      CHECK(journal.undoList().undoCount() == at);
      REQUIRE(differences(journal.points(), states[at]) == 0);
      CHECK(journal.points().present() == states[at].size() - std::ranges::count_if(states[at], &PointState::gone));
      REQUIRE(differences(editor.points(), states[at]) == 0);
      if (versions[at]) {
        CHECK(journal.version() == *versions[at]);
        ++metAgain;
      } else {
        CHECK(std::ranges::count(versions, std::optional(journal.version())) == 0);
        versions[at] = journal.version();
      }
    }
    CHECK(walked > 100);
    CHECK(metAgain > 50);
    give(journal, batch);
    while (journal.undoList().undoCount()) editor.change(journal.undo());
    CHECK(journal.version() == versions[0]);
    CHECK(differences(journal.points(), statesOf(cloud)) == 0);
    CHECK(editedCloud(cloud, journal.points()).positions == cloud.positions);
    CHECK(journal.undoList().dropped() == 0);
  }
}

TEST_CASE("a new stroke discards the redo strokes and frees their memory") {
  const PointCloud cloud = coloredCloud(100);
  Journal journal(cloud, 1 << 20);
  CHECK(journal.undo().empty());
  CHECK(journal.redo().empty());
  journal.follow(strokeOf(0, 10, 1));
  journal.follow(strokeOf(5, 10, 2));
  const std::uint64_t both = journal.undoList().bytes();
  CHECK(journal.undo().size() == 10);
  CHECK(journal.undoList().bytes() == both);
  CHECK(journal.undoList().redoCount() == 1);
  CHECK(journal.points()[7].position.z == 1);
  journal.follow(strokeOf(50, 1, 3));
  CHECK(journal.undoList().redoCount() == 0);
  CHECK(journal.redo().empty());
  CHECK(journal.undoList().bytes() < both);
  CHECK(journal.undoList().undoCount() == 2);
  CHECK(journal.strokes() == 3);
}

TEST_CASE("a stroke keeps a point once, in its state before the first edit") {
  const PointCloud cloud = coloredCloud(100);
  Journal journal(cloud, 1 << 20);
  EditBatch batch;
  for (int tick = 1; tick <= 500; ++tick)
    batch.points.push_back({.position = {0, 0, static_cast<float>(tick)}, .id = static_cast<std::uint32_t>(tick % 7)});
  journal.follow(batch);
  CHECK(journal.inStroke());
  CHECK(journal.undoList().undoCount() == 0);
  const std::uint64_t underWay = journal.version();
  journal.follow(batch);
  CHECK(journal.version() != underWay);
  batch.clear();
  mark(batch, EditMark::Kind::stroke);
  journal.follow(batch);
  CHECK(journal.undoList().bytes() < 9 * sizeof(PointState));
  const auto changes = journal.undo();
  REQUIRE(changes.size() == 7);
  for (const PointChange& change : changes) {
    CHECK(change.from.position.z > 493);
    CHECK(change.to == statesOf(cloud)[change.to.number()]);
  }
}

TEST_CASE("beyond the budget the oldest strokes are dropped first, and counted") {
  const PointCloud cloud = coloredCloud(10'000);
  const std::uint64_t budget = 2500 * sizeof(PointState);
  Journal journal(cloud, budget);
  for (std::uint32_t i = 0; i < 10; ++i) {
    journal.follow(strokeOf(1000 * i, 1000, static_cast<float>(i + 1)));
    CHECK(journal.undoList().bytes() <= budget);
  }
  CHECK(journal.undoList().undoCount() == 2);
  CHECK(journal.undoList().dropped() == 8);
  CHECK(journal.undoList().tooLarge() == 0);
  CHECK(journal.undo().front().to.number() == 9000);
  CHECK(journal.undo().front().to.number() == 8000);
  CHECK(journal.undo().empty());
  CHECK(journal.points()[7000].position.z == 8);
  CHECK(journal.version() != Journal(cloud).version());  // the file's points cannot recur
}

TEST_CASE("a stroke larger than the budget and those before it cannot be undone, those after it can") {
  const PointCloud cloud = coloredCloud(10'000);
  Journal journal(cloud, 2500 * sizeof(PointState));
  journal.follow(strokeOf(0, 100, 1));
  journal.follow(strokeOf(0, 6000, 2));
  CHECK(journal.undoList().undoCount() == 0);
  CHECK(journal.undoList().dropped() == 2);
  CHECK(journal.undoList().tooLarge() == 1);
  CHECK(journal.undoList().bytes() == 0);
  CHECK(journal.points()[5999].position.z == 2);
  journal.follow(strokeOf(200, 100, 3));
  CHECK(journal.undo().size() == 100);
  CHECK(journal.points()[200].position.z == 2);
  CHECK(journal.undo().empty());
}

TEST_CASE("a stroke that removes every point is undone") {
  const PointCloud cloud = coloredCloud(1000);
  Journal journal(cloud, 1 << 20);
  EditBatch batch;
  for (PointState point : statesOf(cloud)) {
    point.id |= PointState::kGone;
    batch.points.push_back(point);
  }
  mark(batch, EditMark::Kind::stroke);
  journal.follow(batch);
  CHECK(editedCloud(cloud, journal.points()).empty());
  CHECK(journal.undo().size() == 1000);
  CHECK(editedCloud(cloud, journal.points()).colors == cloud.colors);
}

TEST_CASE("without a budget the journal follows the points and keeps no stroke") {
  const PointCloud cloud = coloredCloud(100);
  Journal journal(cloud);
  journal.follow(strokeOf(90, 20, 4));
  CHECK(journal.points().size() == 110);
  CHECK(journal.strokes() == 1);
  CHECK(journal.undo().empty());
  CHECK(journal.undoList().bytes() == 0);
  CHECK(journal.undoList().dropped() == 0);
}

TEST_CASE("a journal processes millions of states per second") {
  const PointCloud cloud = coloredCloud(1'000'000);
  std::mt19937 random(5);
  EditBatch batch;
  for (std::size_t i = 0; i < 2'000'000; ++i)
    batch.points.push_back({.id = static_cast<std::uint32_t>(random() % cloud.size())});
  mark(batch, EditMark::Kind::stroke);
  Journal journal(cloud, 1ull << 30);
  const Stopwatch watch;
  journal.follow(batch);
  const double scattered_s = watch.elapsed_s();
  for (std::size_t i = 0; i < batch.points.size(); ++i)
    batch.points[i].id = static_cast<std::uint32_t>(400'000 + i % 10'000);
  const Stopwatch again;
  journal.follow(batch);
  const double brush_s = again.elapsed_s();
  const Stopwatch back;
  const std::size_t undone = journal.undo().size() + journal.undo().size();
  MESSAGE("states a second: " << 2e6 / scattered_s << " all over the cloud, " << 2e6 / brush_s
                              << " under a brush; undone: " << static_cast<double>(undone) / back.elapsed_s());
  CHECK(journal.undoList().undoCount() == 0);
}

TEST_CASE("edits of others belong to no stroke, and stay when a stroke is undone") {
  const PointCloud cloud = coloredCloud(20);
  Journal journal(cloud, 1 << 20);
  const auto file = copyOf(journal.points());
  const auto moved = [&](std::uint32_t point, float z) { return movedTo(z, file[point]); };
  const auto z = [&](std::uint32_t point) { return journal.points()[point].position.z; };
  EditBatch batch;
  append(batch, {moved(1, 10), moved(2, 10), moved(3, 10)});
  mark(batch, EditMark::Kind::part);
  append(batch, {moved(3, 20), moved(4, 20)});
  mark(batch, EditMark::Kind::received);
  append(batch, {moved(4, 30), moved(5, 30)});
  journal.follow(batch);
  CHECK(journal.inStroke());
  CHECK(journal.strokes() == 0);
  batch.clear();
  mark(batch, EditMark::Kind::stroke);
  append(batch, {moved(1, 40)});
  mark(batch, EditMark::Kind::received);
  journal.follow(batch);
  CHECK(journal.strokes() == 1);
  CHECK(z(1) == 40);
  CHECK(z(4) == 30);
  const std::uint64_t before = journal.version();

  const auto backs = journal.undo();
  // Others changed points 1 and 3 last; point 4 returns to their state of it.
  REQUIRE(backs.size() == 3);
  CHECK(z(1) == 40);
  CHECK(z(2) == file[2].position.z);
  CHECK(z(3) == 20);
  CHECK(z(4) == 20);
  CHECK(z(5) == file[5].position.z);
  for (const PointChange& change : backs) CHECK(change.to == journal.points()[change.to.number()]);
  CHECK(journal.version() != before);

  // The same between undo and redo.
  batch.clear();
  append(batch, {moved(2, 50)});
  mark(batch, EditMark::Kind::received);
  journal.follow(batch);
  CHECK(journal.redo().size() == 2);
  CHECK(z(2) == 50);
  CHECK(z(4) == 30);
  CHECK(z(5) == 30);
  CHECK(journal.version() != before);
  CHECK(journal.undo().size() == 2);
  CHECK(z(2) == 50);
  CHECK(journal.undoList().undoCount() == 0);
}

TEST_CASE("a point that a stroke edits before and after an edit of others is undone to its state before the stroke") {
  Journal journal(coloredCloud(20), 1 << 20);
  const auto file = copyOf(journal.points());
  const auto moved = [&](std::uint32_t point, float z) { return movedTo(z, file[point]); };
  EditBatch batch;
  append(batch, {moved(1, 10), moved(2, 10), moved(3, 10)});
  mark(batch, EditMark::Kind::part);
  append(batch, {moved(1, 20)});
  mark(batch, EditMark::Kind::received);
  append(batch, {moved(2, 30), moved(3, 30)});
  mark(batch, EditMark::Kind::stroke);
  journal.follow(batch);
  CHECK(journal.undo().size() == 2);
  CHECK(journal.points()[1] == moved(1, 20));
  CHECK(journal.points()[2] == file[2]);
  CHECK(journal.points()[3] == file[3]);
  CHECK(journal.redo().size() == 2);
  CHECK(journal.points()[3] == moved(3, 30));
}

TEST_CASE("undoing random strokes amid edits of others restores all points except theirs") {
  const PointCloud cloud = coloredCloud(301);
  for (const std::uint32_t seed : {5u, 6u, 7u}) {
    CAPTURE(seed);
    Editor editor(cloud, seed);
    Journal journal(cloud, 1 << 30);
    std::mt19937 random(seed);
    std::vector<PointState> expected = copyOf(journal.points());  // as in the file, except for others' last changes
    std::size_t received = 0;
    for (int step = 0; step < 200; ++step) {
      EditBatch batch;
      append(batch, editor.tick(20));
      if (random() % 3 == 0) {
        mark(batch, EditMark::Kind::part);
        const auto theirs = editor.tick(10);
        append(batch, theirs);
        mark(batch, EditMark::Kind::received);
        for (const PointState& state : theirs) {
          while (expected.size() <= state.number())
            expected.push_back({.id = static_cast<std::uint32_t>(expected.size()) | PointState::kGone});
          expected[state.number()] = state;
        }
        received += theirs.size();
      }
      if (random() % 2) mark(batch, EditMark::Kind::stroke);
      journal.follow(batch);
      REQUIRE(differences(journal.points(), editor.points()) == 0);
    }
    EditBatch batch;
    mark(batch, EditMark::Kind::stroke);
    journal.follow(batch);
    CHECK(received > 100);
    while (journal.undoList().undoCount()) editor.change(journal.undo());
    CHECK(differences(journal.points(), expected) == 0);
    CHECK(differences(editor.points(), expected) == 0);
  }
}

}  // namespace palpate::journal_test
