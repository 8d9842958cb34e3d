// A layer of strokes at any strength is clay: a closed, evenly sampled surface between those before and after, on
// analytic shapes, a thin sheet and scans, with and without later strokes over it.
#include <doctest/doctest.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "engine/cloud/point_tree.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/edit/history.hpp"
#include "engine/edit/layer_attributes.hpp"
#include "engine/edit/stroke_layers.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/error_of.hpp"
#include "tests/labels.hpp"
#include "tests/says.hpp"
#include "tests/scenes.hpp"
#include "tests/shared_files.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate::layer_clay_test {

namespace {

constexpr double kPi = 3.14159265358979323846;

/// The largest side becomes 100.
PointCloud scaled(PointCloud cloud) {
  Vec3 low = cloud.positions[0], high = low;
  for (const Vec3& at : cloud.positions) low = glm::min(low, at), high = glm::max(high, at);
  const Vec3 size = high - low;
  const float scale = 100 / std::max({size.x, size.y, size.z});
  for (Vec3& at : cloud.positions) at = (at - 0.5f * (low + high)) * scale;
  cloud.origin = DVec3(0);
  return cloud;
}

/// Two sides 1.2 apart with noise, in waves.
PointCloud foldedSheet(std::size_t count) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-50, 50);
  std::normal_distribution<double> noise(0, 0.04);
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = unit(random), y = unit(random), side = i % 2 == 0 ? 1 : -1;
    const DVec3 normal = side * glm::normalize(DVec3(-0.5 * std::cos(x / 8), 0, 1));
    cloud.positions.emplace_back(DVec3(x, y, 4 * std::sin(x / 8)) + (0.6 + noise(random)) * normal);
    cloud.normals.emplace_back(normal);
  }
  return cloud;
}

PointCloud cloudNamed(const std::string& name, std::size_t points) {
  if (name == "sheet") return foldedSheet(points);
  if (name == "plane" || name == "sphere") return makeScene(name, points).cloud;
  return scaled(readCloud(sharedFile(name)).cloud);
}

/// Of the points around the strokes.
struct Quality {
  std::size_t points = 0;
  double third = 0, most = 0;  // distance of the third neighbour, 99.9 % and all, by that 99.9 % before the strokes
  double holes = 0;            // share of points with an empty side
  double flipped = 0;          // share that face otherwise than most points around
  double second = 0;           // share with a point that faces the other way within half a spacing
};

std::string words(const Quality& of) {
  return fmt::format("{} points, third neighbour {:.2f}, at most {:.2f}; holes {:.4f}, flipped {:.4f}, second {:.4f}",
                     of.points, of.third, of.most, of.holes, of.flipped, of.second);
}

class Clay {
 public:
  Clay(const std::string& name, BrushKind brush, std::size_t points)
      : cloud_(cloudNamed(name, points)), spacing_(meanSpacing(cloud_)), history_(cloud_, {1 << 29}), brush_(brush) {
    history_.setStrokeLayers(attributes_.strokeLayers());
    touch_ = backEnd_.make(cloud_, {.radius = 4 * spacing_, .brush = options(brush), .threads = 2});
    touch_->edits()->keep();
    const DVec3 top =
        name == "plane" || name == "sheet" || name == "sphere" ? DVec3(1.3, 0.7, 100) : DVec3(20, 30, 100);
    std::array<std::uint32_t, 1> found;
    std::array<double, 1> squared;
    const PointTree tree(cloud_.positions);
    tree.nearest(Vec3(top), found, squared);
    DVec3 at(cloud_.positions[found[0]]), normal(cloud_.normals[found[0]]);
    const DVec3 along = frameAround(normal).u;
    for (int k = 0; k < 14; ++k) {
      std::vector<std::uint32_t> near;
      tree.near(at, 3, near);
      DVec3 middle{0}, facing{0};
      double count = 0;
      for (const std::uint32_t i : near) {
        if (glm::dot(DVec3(cloud_.normals[i]), normal) < 0.3) continue;
        middle += DVec3(cloud_.positions[i]), facing += DVec3(cloud_.normals[i]), ++count;
      }
      if (count < 3) break;
      at = middle / count, normal = glm::normalize(facing);
      way_.push_back({at, normal});
      at += along - glm::dot(along, normal) * normal;
    }
    before_ = states();
    found_ = quality(before_, {});
  }

  static BrushOptions defaults(BrushKind kind) {
    return {.kind = kind, .yieldDepth = 0.5, .pushRate = 0.1, .radius = 6, .strength = 0.5};
  }
  static BrushOptions options(BrushKind kind) {
    const double rate = kind == BrushKind::inflate || kind == BrushKind::smooth ? 0.5 : 0.1;
    return {.kind = kind, .yieldDepth = 0.3, .pushRate = rate, .radius = 6, .strength = 1};
  }
  void stroke(double depth, double aside = 0) {
    const DVec3 side = aside * glm::normalize(glm::cross(way_[0].second, way_.back().first - way_[0].first));
    std::vector<DVec3> keys{way_[0].first + 3.0 * way_[0].second + side};
    if (brush_ == BrushKind::grab) {
      const DVec3 along = 0.5 * (way_[8].first - way_[4].first);
      keys = {way_[4].first + way_[4].second, way_[4].first - way_[4].second,
              way_[4].first + 6.0 * way_[4].second + along, way_[4].first + 12.0 * way_[4].second + along};
    } else {
      for (const auto& [at, normal] : way_) keys.push_back(at - depth * normal + side);
      keys.push_back(way_.back().first + 4.0 * way_.back().second + side);
    }
    const auto ask = [&](const DVec3& hip) { touch_->query({.time_s = time_s_ += 1e-3, .hip = hip}, 0); };
    for (std::size_t k = 0; k + 1 < keys.size(); ++k) {
      const int ticks = std::max(1, static_cast<int>(glm::distance(keys[k], keys[k + 1]) / 0.1));
      for (int i = 0; i < ticks; ++i) ask(glm::mix(keys[k], keys[k + 1], static_cast<double>(i) / ticks));
    }
    for (int i = 0; i < 400; ++i) ask(keys.back());
    take();
  }
  void use(BrushKind brush) { use(options(brush)); }
  void use(const BrushOptions& brush) {
    brush_ = brush.kind;
    touch_->setBrush(brush);
  }
  void layer(bool isOpen) {
    StrokeLayerChange change{.set = {"a"}};
    if (isOpen) change.open = 0;
    history_.make(std::move(change), [&](AttributeChange& made) { attributes_.exchange(made); });
  }
  void slide(double strength) {
    StrokeLayerChange change{.set = attributes_.strokeLayers()[0], .moves = StrokeLayerChange::Points::slide};
    change.set.strength = strength;
    const PointLock lock;
    history_.slide(change, &lock, [&](const PointSet&, const History::MadeChanges& changes) {
      touch_->edits()->change(changes());
      EditBatch batch;
      touch_->edits()->take(batch);
      return true;
    });
  }
  std::vector<PointState> states() const {
    const PointStates& states = history_.points();
    return {states.begin(), states.end()};
  }
  const std::vector<PointState>& before() const { return before_; }
  Quality quality() const { return quality(states(), found_); }
  const Quality& found() const { return found_; }
  double strength() const { return attributes_.strokeLayers()[0].strength; }

 private:
  struct Way {
    DVec3 first, second;  // position and normal
  };
  // `before`: before the strokes.
  Quality quality(const std::vector<PointState>& all, const Quality& before) const {
    std::vector<Vec3> positions, normals;
    for (const PointState& state : all)
      if (!state.gone) positions.push_back(state.position), normals.push_back(state.normal);
    const PointTree tree(positions);
    std::vector<double> thirds;
    std::size_t holes = 0, flipped = 0, second = 0;
    for (std::size_t i = 0; i < positions.size(); ++i) {
      constexpr double kAround = 15;
      if (std::ranges::none_of(way_,
                               [&](const Way& on) { return glm::distance(on.first, DVec3(positions[i])) < kAround; }))
        continue;
      std::array<std::uint32_t, 16> near{};
      std::array<double, 16> squared{};
      tree.nearest(positions[i], near, squared);
      thirds.push_back(std::sqrt(squared[3]));
      const Frame3 frame = frameAround(DVec3(normals[i]));
      std::vector<double> angles;
      int others = 0;
      bool hasSecond = false;
      for (std::size_t k = 1; k < near.size(); ++k) {
        const float facing = glm::dot(normals[near[k]], normals[i]);
        const double distance = std::sqrt(squared[k]);
        others += k <= 6 && facing <= 0;
        hasSecond = hasSecond || (facing < -0.3f && distance < 0.5 * spacing_);
        const DVec3 offset = DVec3(positions[near[k]]) - DVec3(positions[i]);
        if (facing > -0.3f && distance < 2.5 * spacing_)
          angles.push_back(std::atan2(glm::dot(offset, frame.v), glm::dot(offset, frame.u)));
      }
      std::ranges::sort(angles);
      double gap = angles.empty() ? 2 * kPi : angles.front() + 2 * kPi - angles.back();
      for (std::size_t k = 1; k < angles.size(); ++k) gap = std::max(gap, angles[k] - angles[k - 1]);
      holes += gap > 0.9 * kPi;
      flipped += others > 3;
      second += hasSecond;
    }
    const auto count = static_cast<double>(thirds.size());
    std::ranges::sort(thirds);
    const double unit = before.third > 0 ? before.third : 1;
    return {.points = thirds.size(),
            .third = thirds[static_cast<std::size_t>(0.999 * (count - 1))] / unit,
            .most = thirds.back() / unit,
            .holes = static_cast<double>(holes) / count,
            .flipped = static_cast<double>(flipped) / count,
            .second = static_cast<double>(second) / count};
  }

  void take() {
    touch_->finish();
    EditBatch batch;
    touch_->edits()->take(batch);
    batch.marks.assign(1, {batch.points.size(), EditMark::Kind::stroke});
    history_.follow(batch);
  }

  OnPlainBackEnd backEnd_;
  PointCloud cloud_;
  double spacing_;
  LayerAttributes attributes_;
  History history_;
  std::unique_ptr<TouchBackend> touch_;
  double time_s_ = 0;
  BrushKind brush_;
  std::vector<Way> way_;
  std::vector<PointState> before_;
  Quality found_;
};

std::size_t differences(const std::vector<PointState>& a, const std::vector<PointState>& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const bool inA = i < a.size() && !a[i].gone, inB = i < b.size() && !b[i].gone;
    different += inA != inB || (inA && !isSameToTheBit(a[i], b[i]));
  }
  return different;
}

void strokesInLayer(Clay& clay, BrushKind brush) {
  clay.layer(true);
  if (brush == BrushKind::grab || brush == BrushKind::smooth) return clay.stroke(1);
  if (brush != BrushKind::carve) return clay.stroke(3);
  for (const double depth : {2.0, 4.0, 6.0, 7.0}) clay.stroke(depth, depth > 4 ? 1.5 : 0);
}

void strokesOver(Clay& clay, BrushKind layer) {
  const double depth = layer == BrushKind::carve ? 7 : layer == BrushKind::push ? 3 : 0;
  const double aside = layer == BrushKind::grab ? 6 : 1;
  clay.layer(false);
  clay.use(BrushKind::push);
  clay.stroke(depth + 2, aside);
  clay.use(BrushKind::inflate);
  clay.stroke(depth + 1, -aside);
}

/// `slack`: on the third neighbour.
void checkClay(const Clay& clay, const Quality& made, double slack) {
  const Quality now = clay.quality();
  CAPTURE(clay.strength());
  CAPTURE(words(now));
  if (inFullTier()) MESSAGE(fmt::format("{:5.2f}: {}", clay.strength(), words(now)));
  CHECK(now.third < std::max(1.0, made.third) + 0.75 * slack);
  CHECK(now.most < std::max(1.3, made.most) + slack);
  const double beyond = clay.strength() < 0 || clay.strength() > 1 ? 2 : 1;  // there a fiftieth may turn over
  CHECK(now.holes < std::max(clay.found().holes, made.holes) + beyond * 0.025);
  CHECK(now.flipped < std::max(clay.found().flipped, made.flipped) + beyond * 0.01);
  CHECK(now.second < std::max(clay.found().second, made.second) + 0.02);
}

}  // namespace

TEST_CASE("a layer slid to any strength is a closed and evenly sampled surface, also under later strokes" *
          kMoreInFull) {
  using Names = std::vector<std::string>;
  for (const std::string& name :
       byTier(Names{"plane", "sphere"}, Names{"plane", "sphere", "sheet", "bunny_34834.ply", "horse_48485.ply"})) {
    if (name.ends_with(".ply") && sharedFile(name).empty()) continue;
    for (const BrushKind brush :
         {BrushKind::push, BrushKind::grab, BrushKind::carve, BrushKind::inflate, BrushKind::smooth}) {
      CAPTURE(name);
      CAPTURE(traitsOf(brush).name);
      Clay clay(name, brush, byTier(6'000, 20'000));
      strokesInLayer(clay, brush);
      const std::vector<PointState> after = clay.states();
      const Quality made = clay.quality();
      if (inFullTier()) MESSAGE(fmt::format("{}, {}: {}", name, traitsOf(brush).name, words(made)));
      for (const double strength : {-1.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.5, 2.0}) {
        const std::string refused = errorOf([&] { clay.slide(strength); });
        if (brush == BrushKind::push && name == "plane") CHECK(refused.empty());
        if (!refused.empty()) CHECK(says(refused, "layer a: its strength is from "));
        checkClay(clay, made, 1);
      }
      clay.slide(0);
      CHECK(differences(clay.states(), clay.before()) == 0);
      clay.slide(1);
      CHECK(differences(clay.states(), after) == 0);
      strokesOver(clay, brush);
      const std::vector<PointState> later = clay.states();
      const Quality over = clay.quality();
      if (inFullTier()) MESSAGE("with strokes over it: ", words(over));
      for (const double strength : {-1.0, 0.0, 0.25, 0.5, 0.75, 1.5, 2.0}) {
        errorOf([&] { clay.slide(strength); });
        checkClay(clay, over, 2.5);
      }
      clay.slide(1);
      CHECK(differences(clay.states(), later) == 0);
    }
  }
}

TEST_CASE("one stroke with default settings slides from -1 to 2 on a clean surface" * kMoreInFull) {
  using Names = std::vector<std::string>;
  for (const std::string& name : byTier(Names{"plane", "sphere"}, Names{"plane", "sphere", "bunny_34834.ply"})) {
    if (name.ends_with(".ply") && sharedFile(name).empty()) continue;
    for (const BrushKind brush : {BrushKind::push, BrushKind::carve, BrushKind::inflate, BrushKind::smooth}) {
      CAPTURE(name);
      CAPTURE(traitsOf(brush).name);
      Clay clay(name, brush, 30'000);
      clay.use(Clay::defaults(brush));
      clay.layer(true);
      clay.stroke(2.5);
      const Quality made = clay.quality();
      if (inFullTier()) MESSAGE(fmt::format("{}, {}: {}", name, traitsOf(brush).name, words(made)));
      for (const double strength : {-1.0, 0.25, 0.5, 0.75, 2.0}) {
        clay.slide(strength);
        CHECK(clay.strength() == strength);
        const Quality now = clay.quality();
        CAPTURE(strength);
        CAPTURE(words(now));
        if (inFullTier()) MESSAGE(fmt::format("{:5.2f}: {}", strength, words(now)));
        CHECK(now.third < std::max(1.0, made.third) + (strength < 0 || strength > 1 ? 0.4 : 0.1));
        CHECK(now.holes < std::max(clay.found().holes, made.holes) + 0.004);
        CHECK(now.flipped < std::max(clay.found().flipped, made.flipped) + 0.002);
        CHECK(now.second < std::max(clay.found().second, made.second) + 0.002);
      }
      clay.slide(0);
      CHECK(differences(clay.states(), clay.before()) == 0);
    }
  }
}

}  // namespace palpate::layer_clay_test
