// Strokes of this hand amid edits of others.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "engine/edit/history.hpp"
#include "tests/edit/edited_history.hpp"
#include "tests/history_steps.hpp"

namespace palpate::history_test {

TEST_CASE("edits of others belong to no stroke, and stay when a stroke is undone") {
  const PointCloud cloud = coloredCloud(20);
  History history(cloud, {1 << 20});
  const auto file = copyOf(history.points());
  const auto moved = [&](std::uint32_t point, float z) { return movedTo(z, file[point]); };
  const auto z = [&](std::uint32_t point) { return history.points()[point].position.z; };
  EditBatch batch;
  append(batch, {moved(1, 10), moved(2, 10), moved(3, 10)});
  mark(batch, EditMark::Kind::part);
  append(batch, {moved(3, 20), moved(4, 20)});
  mark(batch, EditMark::Kind::received);
  append(batch, {moved(4, 30), moved(5, 30)});
  history.follow(batch);
  CHECK(history.inStroke());
  CHECK(history.counts().strokes == 0);
  batch.clear();
  mark(batch, EditMark::Kind::stroke);
  append(batch, {moved(1, 40)});
  mark(batch, EditMark::Kind::received);
  history.follow(batch);
  CHECK(history.counts().strokes == 1);
  CHECK(z(1) == 40);
  CHECK(z(4) == 30);
  const std::uint64_t before = history.version();

  const auto backs = undone(history);
  // Others changed points 1 and 3 last; point 4 returns to their state of it.
  REQUIRE(backs.size() == 3);
  CHECK(z(1) == 40);
  CHECK(z(2) == file[2].position.z);
  CHECK(z(3) == 20);
  CHECK(z(4) == 20);
  CHECK(z(5) == file[5].position.z);
  for (const PointChange& change : backs) CHECK(change.to == history.points()[change.to.number]);
  CHECK(history.version() != before);

  // The same between undo and redo.
  batch.clear();
  append(batch, {moved(2, 50)});
  mark(batch, EditMark::Kind::received);
  history.follow(batch);
  CHECK(redone(history).size() == 2);
  CHECK(z(2) == 50);
  CHECK(z(4) == 30);
  CHECK(z(5) == 30);
  CHECK(history.version() != before);
  CHECK(undone(history).size() == 2);
  CHECK(z(2) == 50);
  CHECK(history.counts().undoCount == 0);
}

TEST_CASE("a point that a stroke edits before and after an edit of others is undone to its state before the stroke") {
  History history(coloredCloud(20), {1 << 20});
  const auto file = copyOf(history.points());
  const auto moved = [&](std::uint32_t point, float z) { return movedTo(z, file[point]); };
  EditBatch batch;
  append(batch, {moved(1, 10), moved(2, 10), moved(3, 10)});
  mark(batch, EditMark::Kind::part);
  append(batch, {moved(1, 20)});
  mark(batch, EditMark::Kind::received);
  append(batch, {moved(2, 30), moved(3, 30)});
  mark(batch, EditMark::Kind::stroke);
  history.follow(batch);
  CHECK(undone(history).size() == 2);
  CHECK(history.points()[1] == moved(1, 20));
  CHECK(history.points()[2] == file[2]);
  CHECK(history.points()[3] == file[3]);
  CHECK(redone(history).size() == 2);
  CHECK(history.points()[3] == moved(3, 30));
}

TEST_CASE("undoing random strokes amid edits of others restores all points except theirs") {
  const PointCloud cloud = coloredCloud(301);
  for (const std::uint32_t seed : {5u, 6u, 7u}) {
    CAPTURE(seed);
    Editor editor(cloud, seed);
    History history(cloud, {1 << 30});
    std::mt19937 random(seed);
    std::vector<PointState> expected = copyOf(history.points());  // as in the file, except for others' last changes
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
          while (expected.size() <= state.number)
            expected.push_back({.gone = true, .number = static_cast<std::uint32_t>(expected.size())});
          expected[state.number] = state;
        }
        received += theirs.size();
      }
      if (random() % 2) mark(batch, EditMark::Kind::stroke);
      history.follow(batch);
      REQUIRE(differences(history.points(), editor.points()) == 0);
    }
    EditBatch batch;
    mark(batch, EditMark::Kind::stroke);
    history.follow(batch);
    CHECK(received > 100);
    while (history.counts().undoCount) editor.change(undone(history));
    CHECK(differences(history.points(), expected) == 0);
    CHECK(differences(editor.points(), expected) == 0);
  }
}

}  // namespace palpate::history_test
