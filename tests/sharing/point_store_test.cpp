// Stores of points: what a hand feels, sculpts, undoes and saves is the same, wherever its bricks come from.
#include <doctest/doctest.h>

#include <chrono>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <thread>
#include <unordered_set>

#include "engine/cloud/point_store.hpp"
#include "engine/core/clock.hpp"
#include "engine/edit/history.hpp"
#include "haptics/sharing/brick_ledger.hpp"
#include "haptics/sharing/shared_points.hpp"
#include "tests/sharing/brick_hand.hpp"

namespace palpate::point_store_test {

namespace {

/// A store of points that has only some of them at a time, and damages a few.
/// Of the wanted blocks of another store, each comes with every second look, in no order. One in eight comes damaged;
/// it is repaired when it is refused, unless `staysDamaged`.
class FlakyStore final : public PointStore {
 public:
  FlakyStore(PointStore& whole, unsigned seed, bool staysDamaged = false)
      : whole_(whole), random_(seed), staysDamaged_(staysDamaged) {}

  const BrickGrid& grid() const override { return whole_.grid(); }
  void want(std::span<const BrickKey> keys) override {
    wanted_.assign(keys.begin(), keys.end());
    whole_.want(keys);
  }
  std::optional<PointBlock> get(BrickKey key) const override {
    if (!here_.contains(key)) {
      ++notHere_;
      return std::nullopt;
    }
    auto block = whole_.get(key);
    if (block && damaged_.contains(key)) block->checksum ^= 1;
    return block;
  }
  void takeNews(std::vector<BrickKey>& keys) override {
    whole_.takeNews(keys);
    for (const BrickKey key : wanted_) {
      if (random_() % 2 == 0 || here_.contains(key)) continue;
      keys.push_back(key);
      here_.insert(key);
      if (random_() % 8 == 0 && damaged_.insert(key).second) ++damages_;
    }
  }
  void refuse(BrickKey key) override {
    ++refusals_;
    here_.erase(key);
    if (!staysDamaged_) damaged_.erase(key);
  }
  std::size_t refusals() const { return refusals_; }
  std::size_t damages() const { return damages_; }
  std::size_t notHere() const { return notHere_; }
  bool isDamaged(BrickKey key) const { return damaged_.contains(key); }

 private:
  PointStore& whole_;
  std::mt19937 random_;
  bool staysDamaged_;
  std::vector<BrickKey> wanted_;
  std::unordered_set<BrickKey> here_, damaged_;
  std::size_t damages_ = 0, refusals_ = 0;
  mutable std::size_t notHere_ = 0;
};

constexpr BrushOptions kPush{
    .kind = BrushKind::push, .yieldDepth = 0.2, .pushRate = 0.5, .radius = 6, .resample = false};

using ByNumber = std::map<std::uint32_t, std::pair<Vec3, Vec3>>;  // positions and normals

/// The points that a hand saves, by the field that has their numbers.
ByNumber savedBy(const BrickHand& hand) {
  PointCloud cloud;
  hand.touch->readBack(cloud);
  REQUIRE(cloud.extra.size() == 1);
  CHECK(cloud.extra[0].name == "number");
  REQUIRE(cloud.extra[0].data.size() == cloud.size() * sizeof(std::uint32_t));
  ByNumber points;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::uint32_t number = 0;
    std::memcpy(&number, cloud.extra[0].data.data() + i * sizeof number, sizeof number);
    points[number] = {cloud.positions[i], cloud.normals[i]};
  }
  CHECK(points.size() == cloud.size());
  return points;
}

/// The history of a hand's edits.
class HandHistory {
 public:
  explicit HandHistory(BrickTouch& touch) : touch_(touch) { touch.keep(); }
  void follow() {
    EditBatch batch;
    touch_.take(batch);
    history.follow(batch);
  }
  bool undo() { return history.undo(carriers()); }
  bool redo() { return history.redo(carriers()); }
  History history{PointStates(), {1 << 28}};

 private:
  History::Carriers carriers() {
    return {.points = [this](std::span<const PointChange> changes) {
      touch_.change(changes);
      return true;
    }};
  }
  BrickTouch& touch_;
};

struct Felt {
  std::vector<Contact> contacts;
  ByNumber sculpted, undone, redone;
  std::size_t strokes = 0;
};

/// Two strokes along a path in virtual time, both undone, one redone.
Felt feltBy(const Scene& scene, BrickHand& hand) {
  Felt felt;
  HandHistory own(*hand.touch);
  double time_s = 0;
  for (const unsigned seed : {7u, 8u}) {
    for (const DVec3& hip : wanderingPath(scene, 150, 2 * scene.radius, seed))
      felt.contacts.push_back(hand.touch->query({.time_s = time_s += 1e-3, .hip = hip}, 0));
    hand.touch->finish();
    hand.touch->resetHand(0);
    own.follow();
  }
  felt.sculpted = savedBy(hand);
  while (own.undo()) ++felt.strokes;
  own.follow();
  felt.undone = savedBy(hand);
  own.redo();
  own.follow();
  felt.redone = savedBy(hand);
  return felt;
}

/// Whether `part` has no other points, or others of the same numbers.
bool isIn(const ByNumber& part, const ByNumber& all) {
  return std::ranges::all_of(part, [&](const auto& point) {
    const auto there = all.find(point.first);
    return there != all.end() && there->second == point.second;
  });
}

}  // namespace

TEST_CASE("points of a store that has half of them at a time are felt, sculpted, undone and saved as those in memory") {
  const Scene scene = makeScene("bumpy-sphere", 20'000, DVec3(3e5, -1e5, 2e4));
  const std::vector<PointState> states = statesOf(scene.cloud);
  const auto memory = [&] {
    auto bricks = std::make_unique<sharing::ServedBricks>(3 * scene.radius);
    bricks->build(states);
    return bricks;
  };
  const auto all = memory(), again = memory();
  BrickHand hand(scene, {.brush = kPush}, all.get());
  const Felt truth = feltBy(scene, hand);
  CHECK(std::ranges::count_if(truth.contacts, &Contact::touching) > 50);
  CHECK(truth.strokes > 1);
  CHECK(truth.sculpted.size() < states.size());
  ByNumber before;
  for (const PointState& state : states)
    before[static_cast<std::uint32_t>(state.number)] = {state.position, state.normal};
  CHECK_FALSE(isIn(truth.sculpted, before));
  CHECK(isIn(truth.undone, before));
  CHECK_FALSE(isIn(truth.redone, before));
  CHECK(hand.touch->counts().without == 0);

  FlakyStore flaky(*again, 3);
  BrickHand unlucky(scene, {.brush = kPush}, &flaky), network(scene, {.brush = kPush});
  network.source.apply(network.bricks.whole(DVec3(-80), DVec3(80)));
  for (BrickHand* const other : {&unlucky, &network}) {
    CAPTURE(other == &network);
    const Felt felt = feltBy(scene, *other);
    CHECK(std::ranges::equal(felt.contacts, truth.contacts, isSameContact));
    CHECK(felt.strokes == truth.strokes);
    CHECK(isIn(truth.sculpted, felt.sculpted));
    CHECK(isIn(truth.undone, felt.undone));
    CHECK(isIn(truth.redone, felt.redone));
    CHECK(isIn(felt.undone, before));
    CHECK(other->touch->counts().without == 0);
  }
  CHECK(flaky.notHere() > 20);
  CHECK(flaky.damages() > 3);
  CHECK(flaky.refusals() >= flaky.damages());
  CHECK(unlucky.source.takeSaid().size() < flaky.damages());  // each is refused until it is as it should be
}

TEST_CASE("a block that stays damaged is named and felt as missing, and is neither sculpted nor saved") {
  const Scene scene = makeScene("sphere", 20'000);
  const std::vector<PointState> states = statesOf(scene.cloud);
  sharing::ServedBricks all(3 * scene.radius);
  all.build(states);
  FlakyStore flaky(all, 5, true);
  BrickHand hand(scene, {.timeout_s = 0.05, .brush = kPush}, &flaky);
  std::size_t without = 0, felt = 0;
  double time_s = 0;
  for (const DVec3& hip : wanderingPath(scene, 1500, scene.radius, 2)) {
    const std::uint64_t before = hand.touch->counts().without;
    const Contact contact = hand.touch->query({.time_s = time_s += 1e-3, .hip = hip}, 1e6);
    std::this_thread::sleep_for(std::chrono::microseconds(300));
    felt += contact.touching;
    if (hand.touch->counts().without == before) continue;
    ++without;
    CHECK_FALSE(contact.touching);
  }
  REQUIRE(flaky.damages() > 0);
  CHECK(without > 20);
  CHECK(felt > 20);
  const std::vector<std::string> said = hand.source.takeSaid();
  REQUIRE_FALSE(said.empty());
  for (const std::string& text : said) CHECK(text.find("are damaged, and count as missing") != std::string::npos);
  CHECK(said.size() <= flaky.damages());  // each is named once
  CHECK(flaky.refusals() >= (kMaxDamaged - 1) * said.size());
  CHECK(flaky.refusals() <= (kMaxDamaged - 1) * flaky.damages());
  hand.touch->finish();
  std::size_t missing = 0;
  const ByNumber saved = savedBy(hand);
  for (const PointState& state : states) {
    if (!flaky.isDamaged(all.grid().keyAt(DVec3(state.position)))) continue;
    ++missing;
    CHECK_FALSE(saved.contains(static_cast<std::uint32_t>(state.number)));
  }
  CHECK(missing > 10);
}

TEST_CASE("points that have left memory are undone at once, except those that the server refuses") {
  const Scene scene = makeScene("sphere", 20'000);
  BrickHand hand(scene, {.brush = kPush});
  HandHistory own(*hand.touch);
  const DVec3 low(-70), high(70);
  hand.source.apply(hand.bricks.whole(low, high));
  for (int i = 0; i < 100; ++i) hand.touch->query({.time_s = 1e-3 * i, .hip = DVec3(0, 0, 51 - 0.05 * i)}, 0);
  hand.touch->finish();
  own.follow();
  REQUIRE(own.history.points().size() > 30);
  // The server takes the edits, and the hand moves on.
  sharing::SharedPoints server(statesOf(scene.cloud));
  const sharing::Id client{1}, other{2};
  std::uint64_t pieces = 0;
  const auto settle = [&] {
    std::vector<sharing::MadeState> made;
    hand.source.takeMade(made);
    std::vector<PointState> states;
    std::vector<std::uint64_t> replaced;
    for (const sharing::MadeState& each : made) {
      states.push_back(each.state);
      if (each.replaced) replaced.push_back(*each.replaced);
    }
    REQUIRE(server.take(client, ++pieces, states, replaced) == sharing::SharedPoints::Taken::taken);
    BrickUpdate update = BricksOf(server.points(), hand.source.grid()).whole(low, high);
    for (const PointState& state : states) update.settled.push_back(static_cast<std::uint32_t>(state.number));
    hand.source.apply(std::move(update));
    return states;
  };
  const std::vector<PointState> made = settle();
  BrickUpdate gone;
  for (const auto& [key, block] : BricksOf(server.points(), hand.source.grid()).whole(low, high).bricks)
    gone.dropped.push_back(key);
  hand.source.apply(std::move(gone));
  REQUIRE(hand.source.known().points + hand.source.known().own == 0);
  PointState theirs = made.front();
  theirs.position.x += 0.25f;
  REQUIRE(server.take(other, 1, {&theirs, 1}) == sharing::SharedPoints::Taken::taken);
  const Stopwatch since;
  REQUIRE(own.undo());
  CHECK(since.elapsed_s() < 0.25);
  CHECK(hand.source.known().own == made.size());
  settle();
  own.follow();
  CHECK(hand.source.known().own == 0);
  const ByNumber saved = savedBy(hand);
  for (const PointState& state : made) {
    const auto number = static_cast<std::uint32_t>(state.number);
    const Vec3 expected = number == theirs.number ? theirs.position : scene.cloud.positions[number];
    CHECK(saved.at(number).first == expected);
    CHECK(own.history.points()[number].position == expected);
    CHECK(server.points()[number].position == expected);
  }
  // What others have changed is not redone, either.
  REQUIRE(own.redo());
  settle();
  CHECK(savedBy(hand).at(static_cast<std::uint32_t>(theirs.number)).first == theirs.position);
}

TEST_CASE("a point that others have removed or restored is reported to the history of the hand that has edited it") {
  BrickSource source({.edge = 1, .points = 10});
  source.keepEdits();
  const BrickKey key = BrickGrid::keyOf(IVec3(0));
  const auto shows = [&](const std::vector<PointState>& points, std::vector<std::uint32_t> settled) {
    const BricksOf bricks(points, source.grid());
    BrickUpdate update{.bricks = {{key, bricks.block(key)}}};
    update.settled = std::move(settled);
    source.apply(std::move(update));
  };
  const PointState one{.position = Vec3(0.25f), .number = 4, .normal = Vec3(0, 0, 1), .parent = 4};
  PointState made = one;
  made.position.z = 0.5f;
  shows({one}, {});
  source.make(std::vector<PointChange>{{.from = one, .to = made}}, 1);
  source.endStroke();
  madeStates(source);
  shows({made}, {4});
  EditBatch batch;
  source.takeEdits(batch);
  CHECK(batch.points == BareVector<PointState>{one, made});
  batch.clear();
  shows({}, {});
  source.takeEdits(batch);
  REQUIRE(batch.points.size() == 1);
  CHECK(batch.points[0].gone);
  CHECK(batch.marks == std::vector<EditMark>{{1, EditMark::Kind::received}});
  batch.clear();
  shows({made}, {});
  source.takeEdits(batch);
  CHECK(batch.points == BareVector<PointState>{made});
}

TEST_CASE("a store in memory reports changed blocks once they were wanted, with other versions and checksums") {
  std::vector<PointState> states;
  for (std::uint32_t i = 0; i < 4; ++i)
    states.push_back({.position = Vec3(static_cast<float>(i) + 0.5f, 0.5f, 0.5f), .number = i, .parent = i});
  sharing::ServedBricks store(1);
  store.build(states);
  const auto keyAt = [](int x) { return BrickGrid::keyOf(IVec3(x, 0, 0)); };
  const std::vector<BrickKey> wanted{keyAt(0), keyAt(1)};
  store.want(wanted);
  const auto first = store.get(keyAt(0)), second = store.get(keyAt(1));
  REQUIRE(first);
  REQUIRE(second);
  CHECK(first->points->ids == std::vector<std::uint32_t>{0});
  CHECK(first->checksum == checksumOf(*first->points));
  CHECK(first->checksum != second->checksum);
  REQUIRE(store.get(keyAt(9)));
  CHECK(store.get(keyAt(9))->points->size() == 0);
  std::vector<BrickKey> news;
  store.takeNews(news);
  CHECK(news.empty());
  states[0].position.x = 1.25f;
  store.follow(0);
  states[3].position.y = 0.75f;  // in a block that nobody wants
  store.follow(3);
  store.takeNews(news);
  std::ranges::sort(news);
  CHECK(news == wanted);
  for (const BrickKey key : wanted) {
    const auto before = key == keyAt(0) ? first : second;
    CHECK(store.get(key)->version != before->version);
    CHECK(store.get(key)->checksum != before->checksum);
  }
}

}  // namespace palpate::point_store_test
