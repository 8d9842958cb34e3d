// Layers of strokes: their strength slides, and what is before, after and beside their strokes is exact.
#include "engine/edit/stroke_layers.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <random>
#include <string>
#include <vector>

#include "engine/cloud/attribute_bytes.hpp"
#include "engine/edit/layer_attributes.hpp"
#include "tests/edit/edited_history.hpp"
#include "tests/error_of.hpp"
#include "tests/history_steps.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::stroke_layers_test {

using namespace history_test;
using Points = StrokeLayerChange::Points;

namespace {

/// A history with layers of strokes, and a back end that has the points that the history carries out.
struct Sculptor {
  explicit Sculptor(const PointCloud& cloud, const UndoBudget& budget = {1 << 28})
      : history(cloud, budget), backend(statesOf(cloud)) {
    history.setStrokeLayers(attributes.strokeLayers());
  }

  const StrokeLayers& layers() const { return attributes.strokeLayers(); }
  PointState operator[](std::uint64_t point) const { return history.points()[point]; }

  void stroke(const std::vector<PointState>& states) {
    follow(states, EditMark::Kind::stroke);
    set(states);
  }
  void set(StrokeLayerChange change) {
    REQUIRE(layers().fits(change));
    history.make(std::move(change), [&](AttributeChange& made) { attributes.exchange(made); });
  }
  void open(std::uint32_t number, const std::string& name) { set({.number = number, .set = {name}, .open = number}); }
  void close() { set({.number = *layers().open(), .set = layers()[*layers().open()]}); }
  void slide(std::uint32_t number, double strength, bool continues = false) {
    StrokeLayerChange change{.number = number,
                             .set = layers()[number],
                             .open = layers().open(),
                             .moves = continues ? Points::slideContinued : Points::slide};
    change.set.strength = strength;
    history.slide(change, &lock, [&](const PointSet& points, const History::MadeChanges& changes) {
      const std::vector<PointChange> made = changes();
      CHECK(made.size() == points.count());
      for (const PointChange& each : made) {
        CHECK(isSame(backend[each.to.number], each.from));
        set({each.to});
      }
      return true;
    });
  }
  bool undo(bool back = true) {
    const History::Carriers carriers{.points =
                                         [&](std::span<const PointChange> changes) {
                                           for (const PointChange& change : changes) {
                                             CHECK(isSame(backend[change.to.number], change.from));
                                             backend[change.to.number] = change.to;
                                           }
                                           return true;
                                         },
                                     .attributes =
                                         [&](AttributeChange& change) {
                                           attributes.exchange(change);
                                           return true;
                                         }};
    return back ? history.undo(carriers) : history.redo(carriers);
  }
  /// Of the existing points, bit by bit, and of the layers.
  std::string state() const {
    std::string text;
    for (const PointState& point : history.points())
      if (!point.gone)
        text += fmt::format("{} {:a} {:a} {:a} {:a} {}\n", point.number, point.position.x, point.position.y,
                            point.position.z, point.normal.x, point.color);
    for (std::size_t i = 0; i < layers().size(); ++i)
      text += fmt::format("{} {} {} {}\n", layers()[i].name, layers()[i].strength, layers()[i].isMerged,
                          layers().open() == i);
    return text;
  }

  LayerAttributes attributes;
  History history;
  std::vector<PointState> backend;
  PointLock lock;

 private:
  // Where a point is that does not exist concerns the history alone.
  static bool isSame(const PointState& a, const PointState& b) { return (a.gone && b.gone) || isSameToTheBit(a, b); }
  void follow(const std::vector<PointState>& states, EditMark::Kind kind) {
    EditBatch batch{.points = {states.begin(), states.end()}, .marks = {{states.size(), kind}}};
    history.follow(batch);
  }
  void set(const std::vector<PointState>& states) {
    for (const PointState& state : states) {
      if (state.number >= backend.size()) backend.resize(state.number + 1);
      backend[state.number] = state;
    }
  }
};

PointState moved(PointState point, const Vec3& by) {
  point.position += by;
  point.normal = glm::normalize(point.normal + 0.3f * by);
  return point;
}
PointState removed(PointState point) {
  point.gone = true;
  return point;
}

// 12 x 12 points at a distance of 1.
PointCloud gridCloud() {
  PointCloud cloud = coloredCloud(144);
  for (std::size_t i = 0; i < cloud.size(); ++i) cloud.positions[i] = Vec3(i % 12, i / 12, 0);
  return cloud;
}

}  // namespace

TEST_CASE("a layer of strokes with strength 0 is as before them, with 1 as after them, and linear between") {
  const PointCloud cloud = coloredCloud(20);
  Sculptor sculptor(cloud);
  sculptor.stroke({moved(sculptor[3], {0.1f, 0, 0})});
  const std::string before = sculptor.state();
  sculptor.open(0, "wrinkles");
  sculptor.stroke({moved(sculptor[3], {0, 0, 0.7f}), moved(sculptor[4], {0, 0, -0.3f})});
  sculptor.stroke({moved(sculptor[4], {0, 0.2f, 0.1f}), moved(sculptor[5], {1, 2, 3})});
  sculptor.close();
  const std::vector<PointState> after = copyOf(sculptor.history.points());
  const std::size_t entries = sculptor.history.counts().undoCount;
  CHECK(sculptor.layers().pointsOf(0) == 3);
  for (const double strength : {0.25, 0.0, 1.7, -1.0, 0.6}) {
    sculptor.slide(0, strength);
    for (const std::uint64_t point : {std::uint64_t{3}, std::uint64_t{4}, std::uint64_t{5}}) {
      const DVec3 from(point == 3 ? cloud.positions[3] + Vec3(0.1f, 0, 0) : cloud.positions[point]);
      const DVec3 there = from + strength * (DVec3(after[point].position) - from);
      CHECK(glm::distance(DVec3(sculptor[point].position), there) < 1e-6);
      CHECK(glm::length(sculptor[point].normal) == within(1, 1e-6));
    }
    CHECK(isSameToTheBit(sculptor[6], after[6]));
  }
  sculptor.slide(0, 1);
  for (std::size_t i = 0; i < after.size(); ++i) CHECK(isSameToTheBit(sculptor[i], after[i]));
  sculptor.slide(0, 0);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    CHECK(isSameToTheBit(sculptor[i], i == 3 ? moved(statesOf(cloud)[3], {0.1f, 0, 0}) : statesOf(cloud)[i]));
  CHECK(sculptor.history.counts().undoCount == entries + 7);
  for (int i = 0; i < 7 + 4; ++i) CHECK(sculptor.undo());
  CHECK(sculptor.state() == before);
}

TEST_CASE("what other strokes and layers have done to a point stays when its layer slides") {
  const PointCloud cloud = coloredCloud(8);
  Sculptor sculptor(cloud);
  sculptor.open(0, "a");
  sculptor.stroke({moved(sculptor[2], {0, 0, 1})});
  sculptor.open(1, "b");
  sculptor.stroke({moved(sculptor[2], {0, 2, 0})});
  sculptor.close();
  sculptor.stroke({moved(sculptor[2], {4, 0, 0})});
  sculptor.set({.number = 0, .set = sculptor.layers()[0], .open = 0});
  sculptor.stroke({moved(sculptor[2], {0, 0, 8})});  // once more in the first layer
  sculptor.close();
  const auto at = [&] { return sculptor[2].position - cloud.positions[2]; };
  CHECK(glm::distance(at(), Vec3(4, 2, 9)) < 1e-5f);
  sculptor.slide(0, 0.5);
  CHECK(glm::distance(at(), Vec3(4, 2, 4.5f)) < 1e-5f);
  sculptor.slide(1, 0);
  CHECK(glm::distance(at(), Vec3(4, 0, 4.5f)) < 1e-5f);
  sculptor.slide(0, 0);
  CHECK(glm::distance(at(), Vec3(4, 0, 0)) < 1e-5f);
}

TEST_CASE("points that a layer removes return below half its strength, unless something else has removed them") {
  const PointCloud cloud = gridCloud();
  Sculptor sculptor(cloud);
  sculptor.open(0, "cut");
  sculptor.stroke({removed(sculptor[65]), removed(sculptor[66]), moved(sculptor[67], {0, 0, 1})});
  sculptor.open(1, "hole");
  sculptor.stroke({removed(sculptor[67]), removed(sculptor[68])});
  sculptor.close();
  const auto there = [&] {
    std::string text;
    for (std::uint64_t point = 65; point < 69; ++point) text += sculptor[point].gone ? '-' : '+';
    return text;
  };
  CHECK(there() == "----");
  sculptor.slide(0, 0.5);
  CHECK(there() == "----");
  sculptor.slide(0, 0.49);
  CHECK(there() == "++--");
  CHECK(isSameToTheBit(sculptor[65], statesOf(cloud)[65]));
  sculptor.stroke({removed(sculptor[65])});  // in no layer
  sculptor.slide(0, 1);
  CHECK(there() == "----");
  sculptor.slide(0, 0.25);
  CHECK(there() == "-+--");
  sculptor.slide(1, 0);
  CHECK(there() == "-+++");
  CHECK(sculptor[67].position.z - cloud.positions[67].z == within(0.25, 1e-6));
  for (int i = 0; i < 3; ++i) CHECK(sculptor.undo());
  CHECK(sculptor.undo());  // the stroke in no layer
  CHECK(there() == "++--");
  sculptor.slide(0, 1);
  sculptor.slide(0, 0);
  CHECK(there() == "++--");
}

TEST_CASE("points that a layer inserts slide from the surface before it, and do not exist at strength 0") {
  const PointCloud cloud = gridCloud();
  Sculptor sculptor(cloud);
  sculptor.open(0, "bump");
  PointState fresh{
      .position = {5.4f, 5.5f, 0.9f}, .number = 144, .normal = {0, 1, 0}, .color = 0xff00ff00u, .parent = 65};
  PointState second{
      .position = {5.4f, 4.6f, 0.7f}, .number = 145, .normal = {0, 0, 1}, .color = 0xff0000ffu, .parent = 144};
  sculptor.stroke({fresh, second, moved(sculptor[65], {0, 0, 1})});
  sculptor.open(1, "other");
  sculptor.stroke({moved(sculptor[144], {0, 0.2f, 0})});
  sculptor.close();
  for (const double strength : {0.5, 0.125, 2.0}) {
    sculptor.slide(0, strength);
    const DVec3 first(sculptor[144].position), next(sculptor[145].position), other(0, 0.2f, 0);
    CHECK(first.z == within(strength * 0.9, 1e-5));
    CHECK(next.z == within(strength * 0.7, 1e-5));
    for (const DVec3& base :
         {first - strength * (DVec3(fresh.position) + other), next - strength * DVec3(second.position)})
      CHECK(glm::distance(base / (1 - strength), DVec3(cloud.positions[65])) < 1.5);
    CHECK_FALSE(sculptor[144].gone);
  }
  sculptor.slide(0, 0);
  CHECK(sculptor[144].gone);
  CHECK(sculptor[145].gone);
  CHECK(sculptor.history.points().present() == 144);
  sculptor.slide(1, 0.5);  // moves a point that does not exist at present
  sculptor.slide(0, 1);
  CHECK(glm::distance(DVec3(sculptor[144].position), DVec3(5.4f, 5.6f, 0.9f)) < 1e-5);
  CHECK(isSameToTheBit(sculptor[145], second));
}

TEST_CASE("a strength at which the surface would turn over is refused with its reason, and is no entry") {
  Sculptor sculptor(gridCloud());
  sculptor.open(0, "wide");
  std::vector<PointState> stroke;
  for (std::uint64_t point = 0; point < 144; ++point) {
    stroke.push_back(sculptor[point]);
    stroke.back().position.x *= 4;
  }
  sculptor.stroke(stroke);
  sculptor.close();
  const std::string made = sculptor.state();
  const StrokeCounts counts = sculptor.history.counts();
  for (const double strength : {-0.5, -1.0})
    CHECK(says(errorOf([&] { sculptor.slide(0, strength); }), "layer wide: its strength is from -0.25 to 2, since"));
  CHECK(sculptor.state() == made);
  CHECK(sculptor.history.counts().undoCount == counts.undoCount);
  CHECK(sculptor.history.counts().strokes == counts.strokes);
  sculptor.slide(0, 0.5);
  sculptor.slide(0, 1);
  CHECK(sculptor.state() == made);
}

TEST_CASE("points that do not exist at a strength go along with what strokes do to the surface there meanwhile") {
  Sculptor sculptor(gridCloud());
  sculptor.open(0, "bump");
  const PointState fresh{.position = {5.5f, 5.5f, 0.8f}, .number = 144, .normal = {0, 0, 1}, .parent = 65};
  std::vector<PointState> bump{fresh}, over;
  for (const std::uint64_t point : {65, 66, 77, 78}) bump.push_back(moved(sculptor[point], {0, 0, 0.8f}));
  sculptor.stroke(bump);
  sculptor.close();
  sculptor.slide(0, 0);
  CHECK(sculptor[144].gone);
  for (const PointState& state : copyOf(sculptor.history.points()))
    if (!state.gone) over.push_back(moved(state, {0, 0, 0.5f}));
  const std::uint64_t inserted = 145;  // by that stroke, in a place that the layer moves
  over.push_back({.position = {5.5f, 5.0f, 0.5f}, .number = inserted, .normal = {0, 0, 1}, .parent = 65});
  sculptor.stroke(over);
  sculptor.slide(0, 1);
  CHECK_FALSE(sculptor[144].gone);
  CHECK(sculptor[144].position.z == within(1.3, 1e-5));
  CHECK(sculptor[66].position.z == within(1.3, 1e-5));
  CHECK(sculptor[inserted].position.z > 1.1);
  CHECK(glm::length(sculptor[inserted].normal) == within(1, 1e-5));
}

TEST_CASE(
    "a slide leaves locked points as they are, and moves points that are locked in part by the rest of their way") {
  Sculptor sculptor(gridCloud());
  sculptor.open(0, "a");
  std::vector<PointState> stroke;
  for (std::uint64_t point = 64; point < 68; ++point) stroke.push_back(moved(sculptor[point], {0, 0, 0.5f}));
  stroke.push_back(removed(sculptor[68]));
  sculptor.stroke(stroke);
  sculptor.close();
  const std::vector<PointState> after = copyOf(sculptor.history.points());
  sculptor.lock.points.set(65);
  sculptor.lock.points.set(68);
  sculptor.lock.weights.assign(144, 0);
  sculptor.lock.weights[66] = 51;  // a fifth
  sculptor.slide(0, 0);
  for (const std::uint64_t point : {std::uint64_t{65}, std::uint64_t{68}})
    CHECK(isSameToTheBit(sculptor[point], after[point]));
  CHECK(sculptor[66].position.z == within(0.1, 1e-6));
  CHECK(sculptor[67].position.z == 0);
  const std::string held = sculptor.state();
  sculptor.slide(0, 0.5);  // locked points go on from where they are
  CHECK(isSameToTheBit(sculptor[65], after[65]));
  CHECK(sculptor[66].position.z == within(0.1 + 0.8 * 0.15, 1e-6));
  CHECK(sculptor.undo());
  CHECK(sculptor.state() == held);
  sculptor.lock = {};
  sculptor.slide(0, 1);
  for (std::size_t i = 0; i < after.size(); ++i) CHECK(isSameToTheBit(sculptor[i], after[i]));
  sculptor.slide(0, 0.25);
  CHECK(sculptor[65].position.z == within(0.125, 1e-6));
  CHECK(sculptor[66].position.z == within(0.125, 1e-6));
  CHECK_FALSE(sculptor[68].gone);
  for (int i = 0; i < 2; ++i) CHECK(sculptor.undo());
  CHECK(sculptor.state() == held);
  sculptor.slide(0, 1);
  for (std::size_t i = 0; i < after.size(); ++i) CHECK(isSameToTheBit(sculptor[i], after[i]));
}

TEST_CASE("a drag of the strength is one entry, of which the next slide, stroke or undo is not part") {
  const PointCloud cloud = coloredCloud(8);
  Sculptor sculptor(cloud);
  sculptor.open(0, "a");
  sculptor.stroke({moved(sculptor[2], {0, 0, 1})});
  sculptor.close();
  const std::string made = sculptor.state();
  const StrokeCounts counts = sculptor.history.counts();
  sculptor.slide(0, 0.9);
  for (int i = 0; i < 20; ++i) sculptor.slide(0, 0.9 - 0.04 * (i + 1), true);
  const std::string dragged = sculptor.state();
  CHECK(sculptor.history.counts().undoCount == counts.undoCount + 1);
  CHECK(sculptor.history.counts().strokes == counts.strokes + 1);
  CHECK(sculptor.history.bytes() < 5000);
  CHECK(sculptor.undo());
  CHECK(sculptor.state() == made);
  CHECK(sculptor.undo(false));
  CHECK(sculptor.state() == dragged);
  sculptor.slide(0, 0.5, true);  // not after redo
  CHECK(sculptor.history.counts().undoCount == counts.undoCount + 2);
  sculptor.slide(0, 0.4);
  CHECK(sculptor.history.counts().undoCount == counts.undoCount + 3);
  sculptor.stroke({moved(sculptor[3], {0, 0, 1})});
  sculptor.slide(0, 0.3, true);
  CHECK(sculptor.history.counts().undoCount == counts.undoCount + 5);
  for (int i = 0; i < 4; ++i) CHECK(sculptor.undo());
  CHECK(sculptor.state() == dragged);
}

TEST_CASE("random strokes, slides and merges of several layers are undone and redone bit by bit, also from the disk") {
  const ScratchFolder folder;
  const PointCloud cloud = coloredCloud(61);
  for (const std::uint32_t seed : {1u, 2u, 3u}) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<float> unit(-1, 1);
    Sculptor sculptor(cloud, {.bytes = 1 << 14, .folder = folder / "undo", .disk_bytes = 1 << 26});
    std::vector<std::string> states{sculptor.state()};
    std::size_t at = 0, slides = 0;
    for (int step = 0; step < 600; ++step) {
      const StrokeLayers& layers = sculptor.layers();
      const auto number = layers.size() ? static_cast<std::uint32_t>(random() % layers.size()) : 0;
      const std::uint32_t kind = random() % 8;
      if (kind < 3) {
        std::vector<PointState> stroke;
        std::uint64_t next = sculptor.history.points().size();
        for (std::uint64_t point = random() % 5; point < sculptor.history.points().size(); point += 1 + random() % 9) {
          const PointState state = sculptor[point];
          if (state.gone) continue;
          stroke.push_back(random() % 12 == 0 ? removed(state)
                                              : moved(state, {unit(random), unit(random), unit(random)}));
          if (random() % 12 == 0 && next < 200)
            stroke.push_back({.position = state.position + Vec3(unit(random)),
                              .number = next++,
                              .normal = state.normal,
                              .color = state.color,
                              .parent = point});
        }
        sculptor.stroke(stroke);
      } else if (kind == 3 && layers.size() < 4) {
        sculptor.open(static_cast<std::uint32_t>(layers.size()), fmt::format("{}", step));
      } else if (kind == 3 && random() % 8 == 0) {
        StrokeLayer merged = layers[number];
        merged.isMerged = !merged.isMerged;
        sculptor.set({.number = number, .set = merged});
      } else if (kind == 4 && layers.size() > 0) {
        StrokeLayerChange to{.number = number, .set = layers[number]};
        to.set.strength = static_cast<double>(random() % 13) / 4 - 1;
        if (to.set.strength == layers[number].strength) continue;
        sculptor.lock = {};
        if (random() % 2 == 0) sculptor.lock.points = PointSet::range(0, random() % 60);
        if (random() % 4 == 0) sculptor.lock.weights.assign(61, static_cast<std::uint8_t>(random()));
        try {
          sculptor.slide(number, to.set.strength);
        } catch (const Error&) {  // the surface would turn over
          REQUIRE(sculptor.state() == states[at]);
          continue;
        }
        ++slides;
      } else if (kind >= 5) {
        const bool back = kind < 7;
        const bool could = back ? at > 0 : at + 1 < states.size();
        CHECK(sculptor.undo(back) == could);
        if (could) back ? --at : ++at;
        REQUIRE(sculptor.state() == states[at]);
        continue;
      } else {
        continue;
      }
      states.resize(++at);
      states.push_back(sculptor.state());
      REQUIRE(differences(sculptor.backend, sculptor.history.points()) == 0);
    }
    CHECK(slides > 20);
    CHECK(sculptor.history.counts().dropped == 0);
    while (sculptor.undo()) REQUIRE(sculptor.state() == states[--at]);
    CHECK(at == 0);
    CHECK(sculptor.layers().size() == 0);
    while (sculptor.undo(false)) REQUIRE(sculptor.state() == states[++at]);
  }
}

TEST_CASE("a layer of strokes has its points also where strokes are too large for the memory for undo") {
  const PointCloud cloud = coloredCloud(40);
  for (const std::uint64_t bytes : {std::uint64_t{0}, std::uint64_t{600}}) {
    CAPTURE(bytes);
    Sculptor sculptor(cloud, {bytes});
    sculptor.open(0, "a");
    std::vector<PointState> stroke;
    for (std::uint64_t point = 0; point < 40; ++point) stroke.push_back(moved(sculptor[point], {0, 0, 1}));
    sculptor.stroke(stroke);
    CHECK(sculptor.layers().pointsOf(0) == 40);
    sculptor.slide(0, 0);
    CHECK(differences(sculptor.history.points(), statesOf(cloud)) == 0);
  }
}

TEST_CASE("layers of strokes pass as bytes, and damaged ones are refused") {
  const PointCloud cloud = coloredCloud(8);
  Sculptor sculptor(cloud);
  sculptor.open(0, "a");
  sculptor.stroke({moved(sculptor[2], {0, 0, 1}), removed(sculptor[3])});
  sculptor.open(1, "b c");
  sculptor.stroke({moved(sculptor[2], {0, 0, 1})});
  sculptor.lock.points.set(2);
  sculptor.slide(0, 0.3);
  LayerAttributes again;
  for (const AttributeChange& change : sculptor.attributes.all()) {
    const std::vector<std::byte> bytes = bytesIn(change);
    AttributeChange read;
    REQUIRE(readChange(bytes, read));
    CHECK(read == change);
    for (std::size_t end = 0; end < bytes.size(); end += 5) {
      AttributeChange part;
      const bool isRead = readChange(std::span(bytes).first(end), part);
      CHECK((!isRead ||
             std::get<StrokeLayerChange>(part).points.size() < std::get<StrokeLayerChange>(change).points.size()));
    }
    REQUIRE(again.fits(read));
    again.exchange(read);
  }
  CHECK(again.all() == sculptor.attributes.all());
  CHECK(again.strokeLayers()[0].held == std::vector<HeldPoint>{{2, 1}});
  CHECK(std::get<StrokeLayerChange>(again.all().front()).places.size() > 2);
  CHECK_FALSE(again.fits(StrokeLayerChange{.number = 3}));
  CHECK_FALSE(again.fits(StrokeLayerChange{.number = 2, .open = 3}));
  CHECK_FALSE(again.fits(StrokeLayerChange{.number = 0, .isPresent = false}));
  CHECK_FALSE(again.fits(StrokeLayerChange{.number = 1, .set = {.strength = 2.5}}));
  CHECK_FALSE(again.fits(StrokeLayerChange{.number = 2, .points = {{.earlier = 0}}}));
}

}  // namespace palpate::stroke_layers_test
