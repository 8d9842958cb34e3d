// The history of a cloud of which only the edited points are known, held against that of the whole cloud.
#include <doctest/doctest.h>

#include <set>

#include "tests/edit/edited_history.hpp"
#include "tests/history_steps.hpp"

namespace palpate::history_test {

namespace {

/// Both histories of one editor's cloud. That of a part gets the state of each point before its first edit.
class TwoHistories {
 public:
  TwoHistories(const PointCloud& cloud, std::uint32_t seed, const UndoBudget& budget)
      : whole(cloud, budget), part(PointStates(), budget), editor_(cloud, seed) {}

  void edit(bool ends) {
    const std::vector<PointState> before = editor_.points(), states = editor_.tick(20);
    EditBatch all, known;
    append(all, states);
    mark(known, EditMark::Kind::part);
    for (const PointState& state : states) {
      const std::uint64_t point = state.number;
      if (!known_.insert(point).second) continue;
      append(known, {point < before.size() ? before[point] : whole.points()[point]});
    }
    mark(known, EditMark::Kind::received);
    append(known, states);
    for (EditBatch* const batch : {&all, &known})
      if (ends) mark(*batch, EditMark::Kind::stroke);
    whole.follow(all);
    part.follow(known);
  }
  /// Others change points, some of which are in the part.
  void receive() {
    const std::vector<PointState> states = editor_.tick(20);
    EditBatch all, known;
    append(all, states);
    for (const PointState& state : states)
      if (known_.contains(state.number)) append(known, {state});
    for (EditBatch* const batch : {&all, &known}) {
      batch->marks.insert(batch->marks.begin(), {0, EditMark::Kind::part});
      mark(*batch, EditMark::Kind::received);
    }
    whole.follow(all);
    part.follow(known);
  }
  /// Undo or redo by both; the number of points that both change, in the same way.
  std::size_t goBack(bool undo) {
    const std::vector<PointChange> changes = undo ? undone(whole) : redone(whole),
                                   same = undo ? undone(part) : redone(part);
    REQUIRE(changes.size() == same.size());
    for (std::size_t i = 0; i < same.size(); ++i) {
      CHECK(isSameToTheBit(changes[i].from, same[i].from));
      CHECK(isSameToTheBit(changes[i].to, same[i].to));
    }
    editor_.change(changes);
    return changes.size();
  }
  std::size_t known() const { return known_.size(); }

  History whole, part;

 private:
  Editor editor_;
  std::set<std::uint64_t> known_;
};

}  // namespace

TEST_CASE("the history of a part undoes and redoes as that of the whole cloud, amid edits of others, within budgets") {
  std::size_t changed = 0, dropped = 0;
  for (const std::uint64_t budget : {std::uint64_t{1} << 30, std::uint64_t{60 * sizeof(PointState)}, std::uint64_t{0}})
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      CAPTURE(budget);
      CAPTURE(seed);
      TwoHistories both(coloredCloud(2000), seed, {budget});
      std::mt19937 random(seed);
      for (int step = 0; step < 120; ++step) {
        const auto dice = random() % 6;
        both.edit(true);
        if (dice == 0) both.edit(false);
        if (dice <= 1) both.receive();
        if (dice == 0) both.edit(true);
        if (dice >= 3) changed += both.goBack(true);
        if (dice >= 4) changed += both.goBack(true);
        if (dice == 5) changed += both.goBack(false);
        const StrokeCounts a = both.whole.counts(), b = both.part.counts();
        CHECK(a.undoCount == b.undoCount);
        CHECK(a.redoCount == b.redoCount);
        CHECK(a.dropped == b.dropped);
      }
      dropped += both.part.counts().dropped;
      CHECK(both.part.points().size() == both.known());
      CHECK(both.whole.points().size() >= 2000);
      for (const PointState& state : both.part.points())
        CHECK(isSameToTheBit(state, both.whole.points()[state.number]));
    }
  CHECK(changed > 1000);
  CHECK(dropped > 50);
}

TEST_CASE("the first state of a point in a part is no change by others, and memory follows the part alone") {
  History history(PointStates(), {1 << 20});
  constexpr std::uint64_t kFar = std::uint64_t{1} << 40;
  const PointState before{.position = Vec3(1), .number = kFar, .parent = kFar};
  const std::uint64_t version = history.version();
  EditBatch batch;
  append(batch, {before});
  mark(batch, EditMark::Kind::received);
  append(batch, {movedTo(5, before)});
  mark(batch, EditMark::Kind::stroke);
  give(history, batch);
  CHECK(history.points().size() == 1);
  CHECK(history.points().present() == 1);
  CHECK(history.points()[kFar - 1].gone);
  const auto back = undone(history);
  REQUIRE(back.size() == 1);
  CHECK(back[0].to == before);
  CHECK(history.version() == version);
  CHECK(redone(history).size() == 1);
  append(batch, {movedTo(6, before)});
  mark(batch, EditMark::Kind::received);
  give(history, batch);
  CHECK(undone(history).empty());
  CHECK(history.points()[kFar].position.z == 6);
}

}  // namespace palpate::history_test
