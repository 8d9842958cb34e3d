// Masks and fields beside the points: set, undone and redone in one order with strokes, lost and kept with points.
#include "engine/edit/layer_attributes.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include "engine/core/clock.hpp"
#include "engine/core/error.hpp"
#include "tests/edit/edited_history.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::history_test {

namespace {

/// A history, the attributes of its points, and a follower of their changes.
class Layered {
 public:
  Layered(const PointCloud& cloud, const UndoBudget& budget, std::uint32_t seed)
      : file(cloud), editor(cloud, seed), history(cloud, budget), random_(seed) {
    for (const auto& [name, type] : {std::pair("height", ScalarType::f32), std::pair("class", ScalarType::u8)})
      for (LayerAttributes* each : {&attributes, &followed}) {
        AttributeChange made = initialField(cloud, history.points(), name, type, each->fields().size());
        each->exchange(made);
      }
  }

  void stroke() {
    EditBatch batch;
    for (int tick = 0; tick < 4; ++tick) append(batch, editor.tick(20));
    if (batch.empty()) batch.points.push_back(editor.points()[0]);
    mark(batch, EditMark::Kind::stroke);
    take(batch);
  }
  void set(AttributeChange change) {
    EditBatch batch{.attributes = {change}};
    history.make(std::move(change), [&](AttributeChange& made) { attributes.exchange(made); });
    take(batch);
  }
  void setMask(MaskRole role) { set(MaskFlip{.role = role, .points = somePoints()}); }
  void setField(std::uint32_t field) {
    FieldChange change{.field = field, .points = somePoints()};
    change.values.resize(change.points.count() * sizeOf(attributes.fields()[field].values.type));
    for (std::byte& byte : change.values) byte = static_cast<std::byte>(random_());
    set(std::move(change));
  }
  void makeField(const std::string& name) {
    set(initialField(file, history.points(), name, ScalarType::i64, attributes.fields().size()));
  }
  bool undo(bool back = true) {
    EditBatch batch;
    const History::Carriers carriers{.points =
                                         [&](std::span<const PointChange> changes) {
                                           append(batch, editor.change(changes));
                                           mark(batch, EditMark::Kind::change);
                                           return true;
                                         },
                                     .attributes =
                                         [&](AttributeChange& change) {
                                           batch.attributes.push_back(change);
                                           attributes.exchange(change);
                                           return true;
                                         }};
    const bool done = back ? history.undo(carriers) : history.redo(carriers);
    take(batch);
    return done;
  }

  /// All that the existing points have, in words.
  std::string state() const {
    std::string state;
    for (const PointState& point : history.points()) {
      if (point.gone) continue;
      state += fmt::format("{} {}", point.number, point.position.x);
      for (std::size_t role = 0; role < kMaskRoles; ++role)
        state += attributes.mask(static_cast<MaskRole>(role)).test(point.number) ? " 1" : " 0";
      for (const Field& field : attributes.fields()) {
        const std::size_t bytes = sizeOf(field.values.type);
        for (std::size_t i = 0; i < bytes; ++i)
          state += fmt::format(" {:02x}", static_cast<unsigned>(field.values.data.at(point.number * bytes + i)));
      }
      state += '\n';
    }
    return state;
  }
  bool isFollowed() const {
    for (std::size_t role = 0; role < kMaskRoles; ++role)
      if (attributes.mask(static_cast<MaskRole>(role)) != followed.mask(static_cast<MaskRole>(role))) return false;
    if (attributes.fields().size() != followed.fields().size()) return false;
    for (std::size_t i = 0; i < attributes.fields().size(); ++i)
      if (attributes.fields()[i].values.data != followed.fields()[i].values.data) return false;
    return true;
  }

 private:
  PointSet somePoints() {
    PointSet points;
    for (int i = 0; i < 30; ++i) points.set(random_() % history.points().size());
    return points;
  }
  void take(EditBatch& batch) {
    attributes.follow(batch, history.points());
    history.follow(batch);
    for (AttributeChange& change : batch.attributes) followed.exchange(change);
  }

 public:
  PointCloud file;
  Editor editor;
  History history;
  LayerAttributes attributes, followed;

 private:
  std::mt19937 random_;
};

}  // namespace

TEST_CASE("masks, fields and strokes that add and remove points are undone and redone exactly, in one order") {
  const ScratchFolder folder;
  for (const std::uint64_t memory : {1u << 28, 20'000u}) {  // all in memory; most on the disk
    CAPTURE(memory);
    Layered layered(coloredCloud(300), {memory, folder.path(), 1 << 28}, 7);
    std::mt19937 random(11);
    std::vector<std::string> states{layered.state()};
    std::vector<std::uint64_t> versions{layered.history.version()};
    std::size_t at = 0, walked = 0;
    for (int step = 0; step < 400; ++step) {
      const std::uint64_t before = layered.history.version();
      const unsigned kind = random() % 8;
      if (kind < 4) {
        if (kind == 0) layered.setMask(static_cast<MaskRole>(random() % kMaskRoles));
        if (kind == 1) layered.setField(random() % layered.attributes.fields().size());
        if (kind == 2 && step % 3 == 0)
          layered.makeField(fmt::format("field {}", step));
        else if (kind > 1)
          layered.stroke();
        CHECK((layered.history.version() == before) == (kind == 0));  // no mask is in a file
        states.resize(++at);
        versions.resize(at);
        states.push_back(layered.state());
        versions.push_back(layered.history.version());
      } else {
        const bool back = random() % 3 != 0;
        const bool can = back ? at > 0 : at + 1 < states.size();
        CHECK(layered.undo(back) == can);
        if (can) back ? --at : ++at;
        walked += can;
      }
      REQUIRE(layered.state() == states[at]);
      REQUIRE(layered.isFollowed());
      CHECK(layered.history.version() == versions[at]);
      CHECK(layered.history.counts().undoCount == at);
    }
    CHECK(walked > 100);
    while (layered.undo()) --at;
    CHECK(at == 0);
    CHECK(layered.state() == states[0]);
    CHECK(layered.history.counts().dropped == 0);
  }
}

TEST_CASE("a new point has its parent's masks and values, and a removed one counts again once it is restored") {
  const PointCloud cloud = coloredCloud(10);
  Layered layered(cloud, {1 << 20}, 1);
  layered.set(MaskFlip{.role = MaskRole::hidden, .points = PointSet::range(2, 5)});
  layered.set(FieldChange{.field = 1, .points = PointSet::range(3, 4), .values = {std::byte{9}}});
  EditBatch batch{.points = {{.number = 10, .parent = 3}, {.number = 11, .parent = 10}, {.number = 12, .parent = 7}}};
  batch.points.push_back({.gone = true, .number = 2, .parent = 2});
  mark(batch, EditMark::Kind::stroke);
  LayerAttributes& attributes = layered.attributes;
  History& history = layered.history;
  attributes.follow(batch, history.points());
  history.follow(batch);
  const auto hidden = [&] { return existing(attributes.mask(MaskRole::hidden), history.points()); };
  PointSet expected = PointSet::range(3, 5);
  expected.flip(PointSet::range(10, 12));
  CHECK(hidden() == expected);
  CHECK(attributes.fields()[1].values.data.at(11) == std::byte{9});
  CHECK(attributes.fields()[1].values.data.at(12) == std::byte{0});
  CHECK(batch.attributes.size() == 3);  // for followers: one mask, two fields

  const PointCloud edited = editedCloud(cloud, history.points(), attributes.fields());
  REQUIRE(edited.extra.size() == 2);
  CHECK(edited.extra[1].name == "class");
  std::vector<std::byte> values(12);
  values[2] = values[9] = values[10] = std::byte{9};
  CHECK(edited.extra[1].data == values);

  EditBatch back{.points = {{.number = 2, .parent = 2}}};
  mark(back, EditMark::Kind::change);
  history.follow(back);
  expected.set(2);
  CHECK(hidden() == expected);
}

TEST_CASE("an exchange of a mask that is refused, or fails, changes neither side") {
  const PointCloud cloud = coloredCloud(10);
  History history(cloud, {1 << 20});
  history.make(MaskFlip{.points = PointSet::range(2, 5)}, [](AttributeChange&) {});
  const std::uint64_t bytes = history.bytes();
  PointSet seen;
  const auto look = [&](AttributeChange& change) { seen = std::get<MaskFlip>(change).points; };
  CHECK_FALSE(history.undo({.attributes = [&](AttributeChange& change) {
    look(change);
    return false;
  }}));
  CHECK_THROWS_AS(history.undo({.attributes = [](AttributeChange&) -> bool { throw Error("no"); }}), Error);
  CHECK(history.counts().undoCount == 1);
  CHECK(history.counts().redoCount == 0);
  CHECK(history.bytes() == bytes);
  CHECK(history.undo({.attributes = [&](AttributeChange& change) {
    look(change);
    return true;
  }}));
  CHECK(seen == PointSet::range(2, 5));
  CHECK(history.counts().redoCount == 1);
}

TEST_CASE("a flip of 25 million scattered points of 50 million takes at most 8 MB") {
  constexpr std::uint64_t kPoints = 50'000'000, kPages = kPoints / PointSet::kPage, kWords = PointSet::kPage / 64;
  std::mt19937_64 random(5);
  std::vector<std::uint64_t> words{kPages};
  for (std::uint64_t page = 0; page < kPages; ++page) {
    words.insert(words.end(), {page, kWords});
    for (std::uint64_t k = 0; k < kWords; ++k) words.push_back(random());
  }
  std::span<const std::uint64_t> rest = words;
  MaskFlip flip;
  REQUIRE(flip.points.read(rest));
  CHECK(flip.points.count() > 24'900'000);
  LayerAttributes attributes;
  History history(PointCloud(), {1 << 28});
  history.make(flip, [&](AttributeChange& made) { attributes.exchange(made); });
  CHECK(history.bytes() <= 8'000'000);
  const Stopwatch since;
  CHECK(history.undo({.attributes = [&](AttributeChange& undone) {
    attributes.exchange(undone);
    return true;
  }}));
  MESSAGE(fmt::format("{} bytes, undone in {:.1f} ms", history.bytes(), 1e3 * since.elapsed_s()));
  CHECK(attributes.mask(MaskRole::selected).empty());
}

}  // namespace palpate::history_test
