#include "engine/edit/history.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <optional>
#include <random>

#include "engine/core/clock.hpp"
#include "tests/edit/edited_history.hpp"
#include "tests/history_steps.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::history_test {

TEST_CASE("undo and redo of random strokes of every kind restore each state bit by bit") {
  const PointCloud cloud = coloredCloud(257);
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    CAPTURE(seed);
    Editor editor(cloud, seed);
    History history(cloud, {1 << 30});
    std::mt19937 random(seed + 100);
    std::vector<std::vector<PointState>> states{copyOf(editor.points())};   // after each stroke that is not undone
    std::vector<std::optional<std::uint64_t>> versions{history.version()};  // where examined
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
            give(history, batch);
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
        give(history, batch);
      } else {
        give(history, batch);
        const bool back = random() % 3 != 0;
        const auto changes = back ? undone(history) : redone(history);
        if (back ? at > 0 : at + 1 < states.size()) back ? --at : ++at;
        append(batch, editor.change(changes));
        if (!changes.empty()) mark(batch, EditMark::Kind::change);
        give(history, batch);
        ++walked;
      }
      CHECK_FALSE(history.inStroke());
      CHECK(history.counts().undoCount == at);
      REQUIRE(differences(history.points(), states[at]) == 0);
      CHECK(history.points().present() == states[at].size() - std::ranges::count_if(states[at], &PointState::gone));
      REQUIRE(differences(editor.points(), states[at]) == 0);
      if (versions[at]) {
        CHECK(history.version() == *versions[at]);
        ++metAgain;
      } else {
        CHECK(std::ranges::count(versions, std::optional(history.version())) == 0);
        versions[at] = history.version();
      }
    }
    CHECK(walked > 100);
    CHECK(metAgain > 50);
    give(history, batch);
    while (history.counts().undoCount) editor.change(undone(history));
    CHECK(history.version() == versions[0]);
    CHECK(differences(history.points(), statesOf(cloud)) == 0);
    CHECK(editedCloud(cloud, history.points()).positions == cloud.positions);
    CHECK(history.counts().dropped == 0);
  }
}

TEST_CASE("a new stroke discards the redo strokes and frees their memory") {
  const PointCloud cloud = coloredCloud(100);
  History history(cloud, {1 << 20});
  CHECK(undone(history).empty());
  CHECK(redone(history).empty());
  history.follow(strokeOf(0, 10, 1));
  history.follow(strokeOf(5, 10, 2));
  const std::uint64_t both = history.bytes();
  CHECK(undone(history).size() == 10);
  CHECK(history.bytes() == both);
  CHECK(history.counts().redoCount == 1);
  CHECK(history.points()[7].position.z == 1);
  history.follow(strokeOf(50, 1, 3));
  CHECK(history.counts().redoCount == 0);
  CHECK(redone(history).empty());
  CHECK(history.bytes() < both);
  CHECK(history.counts().undoCount == 2);
  CHECK(history.counts().strokes == 3);
}

TEST_CASE("a stroke keeps a point once, in its state before the first edit") {
  const PointCloud cloud = coloredCloud(100);
  History history(cloud, {1 << 20});
  EditBatch batch;
  for (int tick = 1; tick <= 500; ++tick)
    batch.points.push_back(
        {.position = {0, 0, static_cast<float>(tick)}, .number = static_cast<std::uint32_t>(tick % 7)});
  history.follow(batch);
  CHECK(history.inStroke());
  CHECK(history.counts().undoCount == 0);
  const std::uint64_t underWay = history.version();
  history.follow(batch);
  CHECK(history.version() != underWay);
  batch.clear();
  mark(batch, EditMark::Kind::stroke);
  history.follow(batch);
  CHECK(history.bytes() < sizeof(HistoryChange) + 8 * sizeof(PointState));
  const auto changes = undone(history);
  REQUIRE(changes.size() == 7);
  for (const PointChange& change : changes) {
    CHECK(change.from.position.z > 493);
    CHECK(change.to == statesOf(cloud)[change.to.number]);
  }
}

TEST_CASE(
    "a stroke that removes most points of a cloud is undone within a budget that its states exceed, also from disk") {
  constexpr std::size_t kCount = 100'000;
  const PointCloud cloud = coloredCloud(kCount);
  const std::vector<PointState> whole = statesOf(cloud);
  const ScratchFolder folder;
  History history(cloud, {.bytes = 40'000, .folder = folder.path(), .disk_bytes = 1 << 20});
  const auto removal = [&](std::size_t begin, std::size_t end) {
    EditBatch batch;
    for (std::size_t i = begin; i < end; ++i) {
      batch.points.push_back(whole[i]);
      batch.points.back().gone = true;
    }
    mark(batch, EditMark::Kind::stroke);
    return batch;
  };
  const std::uint64_t version = history.version();
  history.follow(removal(5, kCount - 7));
  CHECK(history.points().present() == 12);
  CHECK(history.bytes() < 30'000);
  CHECK(history.version() != version);
  CHECK(history.counts().strokes == 1);
  history.follow(strokeOf(0, 3, 1));
  history.follow(removal(0, 2));
  for (int i = 0; i < 40; ++i) history.follow(strokeOf(3, 4, static_cast<float>(i)));  // pushes others to the disk
  CHECK(history.counts().dropped == 0);
  const std::vector<PointState> last = copyOf(history.points());
  const std::size_t all = history.counts().undoCount;
  CHECK(all == 43);
  while (history.counts().undoCount > 0) CHECK_FALSE(undone(history).empty());
  CHECK(differences(history.points(), whole) == 0);
  CHECK(history.version() == version);
  CHECK(history.points().present() == kCount);
  while (history.counts().redoCount > 0) CHECK_FALSE(redone(history).empty());
  CHECK(differences(history.points(), last) == 0);
}

TEST_CASE("undo of a removal leaves points that others have restored or moved since") {
  const PointCloud cloud = coloredCloud(100);
  History history(cloud, {1 << 20});
  EditBatch batch;
  for (std::uint32_t i = 10; i < 20; ++i) {
    batch.points.push_back(statesOf(cloud)[i]);
    batch.points.back().gone = true;
  }
  mark(batch, EditMark::Kind::stroke);
  history.follow(batch);
  batch.clear();
  PointState moved = statesOf(cloud)[12];
  moved.position.z = 9;
  batch.points = {moved};
  mark(batch, EditMark::Kind::received);
  history.follow(batch);
  const auto changes = undone(history);
  CHECK(changes.size() == 9);
  CHECK(std::ranges::none_of(changes, [](const PointChange& change) { return change.to.number == 12; }));
  CHECK(history.points()[12] == moved);
  CHECK(history.points().present() == 100);
  CHECK(redone(history).size() == 9);
  CHECK(history.points()[12] == moved);
  CHECK(history.points().present() == 91);
}

TEST_CASE("beyond the budget the oldest strokes are dropped first, and counted") {
  const PointCloud cloud = coloredCloud(10'000);
  const std::uint64_t budget = 2500 * sizeof(PointState);
  History history(cloud, {budget});
  for (std::uint32_t i = 0; i < 10; ++i) {
    history.follow(strokeOf(1000 * i, 1000, static_cast<float>(i + 1)));
    CHECK(history.bytes() <= budget);
  }
  CHECK(history.counts().undoCount == 2);
  CHECK(history.counts().dropped == 8);
  CHECK(history.counts().tooLarge == 0);
  CHECK(undone(history).front().to.number == 9000);
  CHECK(undone(history).front().to.number == 8000);
  CHECK(undone(history).empty());
  CHECK(history.points()[7000].position.z == 8);
  CHECK(history.version() != History(cloud).version());  // the file's points cannot recur
}

TEST_CASE("a stroke larger than the budget and those before it cannot be undone, those after it can") {
  const PointCloud cloud = coloredCloud(10'000);
  History history(cloud, {2500 * sizeof(PointState)});
  history.follow(strokeOf(0, 100, 1));
  history.follow(strokeOf(0, 6000, 2));
  CHECK(history.counts().undoCount == 0);
  CHECK(history.counts().dropped == 2);
  CHECK(history.counts().tooLarge == 1);
  CHECK(history.bytes() == 0);
  CHECK(history.points()[5999].position.z == 2);
  history.follow(strokeOf(200, 100, 3));
  CHECK(undone(history).size() == 100);
  CHECK(history.points()[200].position.z == 2);
  CHECK(undone(history).empty());
}

TEST_CASE("a stroke that removes every point is undone") {
  const PointCloud cloud = coloredCloud(1000);
  History history(cloud, {1 << 20});
  EditBatch batch;
  for (PointState point : statesOf(cloud)) {
    point.gone = true;
    batch.points.push_back(point);
  }
  mark(batch, EditMark::Kind::stroke);
  history.follow(batch);
  CHECK(editedCloud(cloud, history.points()).empty());
  CHECK(undone(history).size() == 1000);
  CHECK(editedCloud(cloud, history.points()).colors == cloud.colors);
}

TEST_CASE("without a budget the history follows the points and keeps no stroke") {
  const PointCloud cloud = coloredCloud(100);
  History history(cloud);
  history.follow(strokeOf(90, 20, 4));
  CHECK(history.points().size() == 110);
  CHECK(history.counts().strokes == 1);
  CHECK(undone(history).empty());
  CHECK(history.bytes() == 0);
  CHECK(history.counts().dropped == 0);
}

TEST_CASE("a history processes millions of states per second") {
  const PointCloud cloud = coloredCloud(1'000'000);
  std::mt19937 random(5);
  EditBatch batch;
  for (std::size_t i = 0; i < 2'000'000; ++i)
    batch.points.push_back({.number = static_cast<std::uint32_t>(random() % cloud.size())});
  mark(batch, EditMark::Kind::stroke);
  History history(cloud, {1ull << 30});
  const Stopwatch watch;
  history.follow(batch);
  const double scattered_s = watch.elapsed_s();
  for (std::size_t i = 0; i < batch.points.size(); ++i)
    batch.points[i].number = static_cast<std::uint32_t>(400'000 + i % 10'000);
  const Stopwatch again;
  history.follow(batch);
  const double brush_s = again.elapsed_s();
  const Stopwatch back;
  const std::size_t both = undone(history).size() + undone(history).size();
  MESSAGE("states a second: " << 2e6 / scattered_s << " all over the cloud, " << 2e6 / brush_s
                              << " under a brush; undone: " << static_cast<double>(both) / back.elapsed_s());
  CHECK(history.counts().undoCount == 0);
}

TEST_CASE("strokes that the memory does not hold are undone from the disk, bit by bit") {
  const ScratchFolder folder;
  const PointCloud cloud = coloredCloud(400);
  History history(cloud, {.bytes = 100 * sizeof(PointState), .folder = folder.path(), .disk_bytes = 1 << 24});
  Editor editor(cloud, 3);
  std::vector<std::vector<PointState>> states{copyOf(editor.points())};
  while (states.size() < 60) {
    EditBatch batch;
    append(batch, editor.tick(30));
    if (batch.points.empty()) continue;
    mark(batch, EditMark::Kind::stroke);
    give(history, batch);
    states.push_back(copyOf(editor.points()));
  }
  CHECK(history.bytes() <= 100 * sizeof(PointState));
  CHECK(history.counts().undoCount == states.size() - 1);
  CHECK(history.counts().dropped == 0);
  for (std::size_t at = states.size() - 1; at-- > 0;) {
    REQUIRE(!undone(history).empty());
    REQUIRE(differences(history.points(), states[at]) == 0);
  }
  CHECK(history.version() == 0);
  for (std::size_t at = 1; at < states.size(); ++at) {
    REQUIRE(!redone(history).empty());
    REQUIRE(differences(history.points(), states[at]) == 0);
  }
}

TEST_CASE("strokes of a shape and of points are undone in the order in which they were made") {
  const PointCloud cloud = coloredCloud(4);
  History history(cloud, {1 << 20});
  std::vector<RestPlace> shape{{0, Vec3(1)}, {1, Vec3(2)}};
  const auto exchange = [&](ShapeStroke& stroke) {
    for (RestPlace& place : stroke.places) std::swap(place.moved, shape[place.node].moved);
    return true;
  };
  std::vector<PointChange> changes;
  History::Carriers carriers = collecting(changes);
  carriers.shape = exchange;
  history.follow(strokeOf(0, 2, 5));
  history.follow({ShapeStroke{{{1, Vec3(0)}}}, ShapeStroke{{{0, Vec3(-1)}, {1, Vec3(1)}}}});
  CHECK(history.counts().strokes == 3);
  const std::uint64_t version = history.version();
  CHECK(history.undo(carriers));
  CHECK(shape == std::vector<RestPlace>{{0, Vec3(-1)}, {1, Vec3(1)}});
  CHECK(history.undo(carriers));
  CHECK(shape == std::vector<RestPlace>{{0, Vec3(-1)}, {1, Vec3(0)}});
  CHECK(changes.empty());
  CHECK(history.undo(carriers));
  CHECK(changes.size() == 2);
  CHECK(history.version() == 0);
  for (int i = 0; i < 3; ++i) CHECK(history.redo(carriers));
  CHECK(shape == std::vector<RestPlace>{{0, Vec3(1)}, {1, Vec3(2)}});
  CHECK(history.version() == version);
}

}  // namespace palpate::history_test
