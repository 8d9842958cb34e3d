// Soft bodies under hands, for each back end.
#pragma once

#include <doctest/doctest.h>

#include <functional>
#include <memory>
#include <vector>

#include "engine/cloud/spacing.hpp"
#include "engine/matter/soft_model.hpp"
#include "engine/matter/soft_touch.hpp"
#include "engine/matter/soft_world.hpp"

namespace palpate {

/// A block on the floor, 40 mm high, without a tool.
inline MatterScene bareBlock() {
  return {.matter = Matter::soft,
          .box_mm = {100, 120, 100},
          .fill_mm = {50, 40, 50},
          .spacing_mm = 5,
          .viscosity_Pa_s = 3,
          .young_Pa = 3e4};
}

/// Makes the simulation that moves a body.
using BodyMaker =
    std::function<std::unique_ptr<MatterSimulation>(const MatterScene& scene, const MatterOptions& matter)>;

struct SoftTouching {
  SoftTouchOptions touch;
  BodyMaker body = [](const MatterScene& scene, const MatterOptions& matter) {
    return std::make_unique<SoftWorld>(scene, matter);
  };
  HandSpring spring{.stiffness_N_per_unit = 0.5, .damping_N_s_per_unit = 0.002, .most_N = 5};
  unsigned threads = 2;
  bool realtime = false;
};

/// Makes the back end that feels the points of a cloud which a source moves.
using SurfaceMaker = std::function<std::unique_ptr<TouchBackend>(const PointCloud& cloud, CloudSource& source,
                                                                 double radius, const SoftTouchOptions& touch)>;

/// A scene under hands; units are millimetres.
class SoftScene {
 public:
  SoftScene(const MatterScene& scene, const SoftTouching& options, const SurfaceMaker& make)
      : model_(softModelOf(scene, {}, options.threads)), cloud_(cloudOf(*model_, scene)) {
    radius_ = 4 * spacingRange(cloud_, options.threads).mean;
    MatterOptions matter{.threads = options.threads};
    matter.soft = model_;
    double reach = 0;
    for (const ToolPoint& point : options.touch.tools.front().points) reach = std::max(reach, glm::length(point.place));
    auto source = std::make_unique<SoftSource>(
        options.body(scene, matter),
        SoftSourceOptions{
            .points = cloud_.size(), .radius = radius_, .toolReach = reach, .mostAtOnce = options.realtime ? 4u : 0u});
    source_ = source.get();
    auto surface = make(cloud_, *source, radius_, options.touch);
    touch_ = std::make_unique<SoftTouch>(std::move(source), std::move(surface), options.touch);
    touch_->begin(options.realtime, std::vector<HandSpring>(options.touch.tools.size(), options.spring));
  }

  SoftTouch& touch() { return *touch_; }
  SoftSource& source() { return *source_; }
  const SoftSource& source() const { return *source_; }
  const MatterSimulation& world() const { return source_->world(); }
  const PointCloud& cloud() const { return cloud_; }
  double radius() const { return radius_; }
  /// Current positions of its points.
  PointCloud points() {
    PointCloud now = cloud_;
    touch_->finish();
    touch_->readBack(now);
    return now;
  }

 private:
  std::shared_ptr<const SoftModel> model_;
  PointCloud cloud_;
  double radius_ = 0;
  SoftSource* source_ = nullptr;
  std::unique_ptr<SoftTouch> touch_;
};

/// Force on a hand for an answer from a spring of the given stiffness and damping, as in the force law, N.
class FeltSpring {
 public:
  explicit FeltSpring(const HandSpring& spring) : spring_(spring) {}
  DVec3 add(const Contact& contact, const DVec3& hip, double dt_s) {
    if (!contact.valid || !contact.touching) {
      isKnown_ = false;
      return DVec3(0);
    }
    const DVec3 stretch = contact.proxy - hip;
    const DVec3 rate = isKnown_ ? (stretch - last_) / dt_s : DVec3(0);
    isKnown_ = true;
    last_ = stretch;
    const DVec3 force = spring_.stiffness_N_per_unit * stretch + spring_.damping_N_s_per_unit * rate;
    if (!(glm::dot(force, contact.normal) > 0)) return DVec3(0);
    const double size = glm::length(force);
    return size > spring_.most_N ? force * (spring_.most_N / size) : force;
  }

 private:
  HandSpring spring_;
  bool isKnown_ = false;
  DVec3 last_{0};
};

/// A flat square that faces down, with `along` points along a side.
inline ToolShape flatPlate(int along, double side) {
  ToolShape shape;
  for (int x = 0; x < along; ++x)
    for (int z = 0; z < along; ++z)
      shape.points.push_back({.place = {side * ((x + 0.5) / along - 0.5), 0, side * ((z + 0.5) / along - 0.5)},
                              .share = 1.0 / (along * along)});
  return shape;
}

}  // namespace palpate
