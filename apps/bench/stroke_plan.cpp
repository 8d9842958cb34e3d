#include "apps/bench/stroke_plan.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/spacing.hpp"
#include "haptics/session/interactive_session.hpp"
#include "haptics/session_clock.hpp"

namespace palpate {

namespace {

constexpr double kDisc = 1.5;       // local spacings: radius of a point in the picture
constexpr double kMinFacing = 0.2;  // of a disc's normal and the sight, for its depth
constexpr double kEvent_s = 0.008;  // of a mouse: 125 a second
constexpr double kSpeed_px_per_s = 600;
constexpr double kBefore_s = 0.3, kFrame_s = 1.0 / 60, kAfter_s = 1;
constexpr int kMaxFrames = 1200;

constexpr double kLifted_mm = 4, kWalkStep_mm = 0.5;
constexpr double kPicture_mm = 100, kMaxZoom = 4, kMaxTilt = 0.9, kMaxDrag_px = 400, kAlong_px = 2;  // by mouse
constexpr double kUsualDepth_mm = 2, kUsualSpeed_mm_per_s = 50;
constexpr std::size_t kMaxHandTicks = 2500;
constexpr std::size_t kMaxPoints = 100'000, kPlaceTries = 300;
constexpr std::size_t kNumbersPerStroke = 4096;  // random numbers that a stroke may use

Model capped(Context& context, Model model) {
  const PointCloud& all = model.cloud;
  if (all.size() <= kMaxPoints) return model;
  PointCloud some;
  some.origin = all.origin;
  const std::size_t every = (all.size() + kMaxPoints - 1) / kMaxPoints;
  for (std::size_t run = 0; run < all.size(); run += every) {
    const std::size_t i = std::min(run + randomBits(1, run) % every, all.size() - 1);
    some.positions.push_back(all.positions[i]);
    some.normals.push_back(all.normals[i]);
  }
  model.cloud = std::move(some);
  const SpacingRange spacing = spacingRange(model.cloud, context.threads());
  model.spacing = spacing.mean, model.wideSpacing = spacing.wide, model.noise = spacing.noise;
  return model;
}

// Random numbers of one stroke.
class Dice {
 public:
  Dice(std::uint64_t seed, std::size_t stroke) : seed_(seed), next_(stroke * kNumbersPerStroke) {}
  double operator()() { return randomUnit(seed_, next_++); }
  double between(double least, double most) { return least * std::pow(most / least, (*this)()); }

 private:
  std::uint64_t seed_, next_;
};

// The hand walks over the surface at its depth, and leaves.
void planPath(StrokeModel& subject, Dice& random, PlannedStroke& plan) {
  const ModelScale& scale = subject.model().scale;
  StrokeResult& result = plan.result;
  const SurfaceSpot start = settle(subject.surface(), result.start, result.normal);
  const double angle = 2 * std::numbers::pi * random();
  const Frame3 frame = frameAround(start.normal);
  // A slow stroke is not longer than the bench can wait for.
  const double longest = result.speed_mm_per_s * kMaxHandTicks / kHandRate_Hz;
  result.speed_mm_per_s =
      std::max(result.speed_mm_per_s, 2 * (result.depth_mm + kLifted_mm) * kHandRate_Hz / kMaxHandTicks);
  result.drag_mm = std::min(result.drag_mm, longest);
  std::vector<SurfaceSpot> way{start};
  const auto spots = walk(subject.surface(), start, std::cos(angle) * frame.u + std::sin(angle) * frame.v,
                          scale.toUnits(kWalkStep_mm), static_cast<std::size_t>(result.drag_mm / kWalkStep_mm));
  double beyond_mm = 0;  // over a border the hand goes on by a radius
  for (const SurfaceSpot& spot : spots) {
    beyond_mm = spot.supported ? 0 : beyond_mm + kWalkStep_mm;
    if (beyond_mm > result.config.radius_mm) break;
    way.push_back(spot);
  }
  result.drag_mm = static_cast<double>(way.size() - 1) * kWalkStep_mm;
  const auto at = [&](const SurfaceSpot& spot, double height_mm) {
    return spot.position + scale.toUnits(height_mm) * spot.normal;
  };
  plan.hips.push_back(at(way.front(), kLifted_mm));
  const auto moveTo = [&](const DVec3& hip, double speed_mm_per_s) {
    const DVec3 from = plan.hips.back();
    const auto ticks =
        static_cast<int>(std::ceil(scale.toMm(glm::distance(from, hip)) / speed_mm_per_s * kHandRate_Hz - 1e-6));
    for (int k = 1; k <= ticks; ++k) plan.hips.push_back(glm::mix(from, hip, static_cast<double>(k) / ticks));
  };
  for (const SurfaceSpot& spot : way) moveTo(at(spot, -result.depth_mm), result.speed_mm_per_s);
  plan.hips.insert(plan.hips.end(), 100, plan.hips.back());
  moveTo(at(way.back(), kLifted_mm), std::max(result.speed_mm_per_s, 100.0));
  plan.hips.insert(plan.hips.end(), 100, plan.hips.back());
  result.ticks = plan.hips.size();
  plan.played.lift_mm = kLifted_mm;
  for (const SurfaceSpot& spot : way) {
    plan.played.spots.push_back(spot.position);
    plan.played.normals.push_back(spot.normal);
  }
}

// A drag over a picture in which the place is visible, or what is in front of it.
void planDrag(StrokeModel& subject, Dice& random, PlannedStroke& plan) {
  const Model& model = subject.model();
  StrokeResult& result = plan.result;
  const Frame3 frame = frameAround(result.normal);
  const double tilt = kMaxTilt * random(), around = 2 * std::numbers::pi * random();
  const DVec3 aside = std::cos(around) * frame.u + std::sin(around) * frame.v;
  const DVec3 sight = -(std::cos(tilt) * result.normal + std::sin(tilt) * aside);
  const double units = model.scale.toUnits(kPicture_mm) / random.between(1, kMaxZoom);
  const auto part = [&] {
    const double angle = 2 * std::numbers::pi * random();
    return random() * kMaxDrag_px / 2 * DVec2(std::cos(angle), std::sin(angle));
  };
  const DVec2 bend_px = part(), to_px = bend_px + part();
  plan.drag = dragOver(model, result.start, sight, units, bend_px, to_px);
  const auto& events = plan.drag->events;
  for (std::size_t k = 1; k < events.size(); ++k) {
    const double length_px = glm::distance(events[k - 1].place_px, events[k].place_px);
    for (double gone_px = 0; gone_px < length_px; gone_px += kAlong_px) {
      const auto spot = plan.drag->found.at(glm::mix(events[k - 1].place_px, events[k].place_px, gone_px / length_px));
      if (!spot) continue;
      if (!plan.played.spots.empty())
        result.drag_mm += model.scale.toMm(glm::distance(spot->place, plan.played.spots.back()));
      plan.played.spots.push_back(spot->place);
      plan.played.normals.push_back(spot->outward);
    }
  }
  if (plan.played.spots.empty()) plan.played.spots = {result.start}, plan.played.normals = {result.normal};
}

}  // namespace

FoundSurface depthPicture(const PointCloud& cloud, double spacing, const Camera& camera, const DVec2& size_px) {
  const auto width = static_cast<int>(size_px.x), height = static_cast<int>(size_px.y);
  std::vector<float> depths(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), 0);
  const Camera::Axes axes = camera.axes();
  const double radius = kDisc * spacing;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 place(cloud.positions[i]), normal(cloud.normals[i]);
    const auto at = camera.project(place, size_px);
    if (!at) continue;
    // The window draws both sides of a disc.
    const double facing = glm::dot(normal, glm::normalize(camera.eye - place));
    const double length = camera.focal_px(size_px.y) * radius / at->z;
    const DVec3 flat = std::copysign(1 / std::max(std::abs(facing), kMinFacing), facing) * normal;
    const auto pixels = [](double from, double to, int most) {
      return std::pair(std::clamp(static_cast<int>(std::ceil(from)), 0, most),
                       std::clamp(static_cast<int>(std::floor(to)) + 1, 0, most));
    };
    const auto [left, right] = pixels(at->x - length - 0.5, at->x + length - 0.5, width);
    const auto [top, bottom] = pixels(at->y - length - 0.5, at->y + length - 0.5, height);
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x) {
        const DVec2 beside = (DVec2(x + 0.5, y + 0.5) - DVec2(*at)) * (at->z / camera.focal_px(size_px.y));
        const DVec3 aside = beside.x * axes.right - beside.y * axes.up;
        const double nearer = glm::dot(aside, flat);
        if (glm::dot(aside, aside) + nearer * nearer > radius * radius) continue;
        float& depth =
            depths[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
        const auto mine = static_cast<float>(at->z + nearer);
        if (depth == 0 || mine < depth) depth = mine;
      }
  }
  return FoundSurface(
      {.depths = std::move(depths), .width = static_cast<std::uint32_t>(width), .camera = camera, .size_px = size_px});
}

MouseDrag dragOver(const Model& model, const DVec3& place, const DVec3& sight, double units, const DVec2& bend_px,
                   const DVec2& to_px) {
  MouseDrag drag;
  Camera& camera = drag.camera;
  const double away = units / (2 * std::tan(glm::radians(camera.fov_deg) / 2));
  camera.target = place;
  camera.eye = place - away * sight;
  camera.up = std::abs(sight.y) < 0.9 ? DVec3(0, 1, 0) : DVec3(1, 0, 0);
  camera.nearDepth = 1e-3 * away;
  drag.found = depthPicture(model.cloud, model.spacing, camera, drag.size_px);
  DVec2 from = 0.5 * drag.size_px;
  drag.events.push_back({kBefore_s, from});
  for (const DVec2& corner : {DVec2(0.5 * drag.size_px + bend_px), DVec2(0.5 * drag.size_px + to_px)}) {
    const auto steps = static_cast<int>(std::ceil(glm::distance(from, corner) / kSpeed_px_per_s / kEvent_s));
    for (int k = 1; k <= steps; ++k)
      drag.events.push_back({drag.events.back().time_s + kEvent_s, glm::mix(from, corner, double(k) / steps)});
    from = corner;
  }
  drag.events.push_back({drag.events.back().time_s + kEvent_s, from});
  return drag;
}

std::vector<PointState> playDrag(const SessionConfig& config, const Model& model, const SessionParts& parts,
                                 const MouseDrag& drag, std::vector<DVec3>& hips) {
  const auto clock = std::make_shared<SteppedClock>();
  InteractiveSession session(config, model, parts, {.clock = clock});
  double clock_s = 0;
  const auto goOn = [&](double duration_s) { session.tickUntil(clock_s += duration_s); };
  goOn(kBefore_s);
  const auto& events = drag.events;
  const std::size_t first = session.recentTicks().rows().size();
  session.press(
      PointerStroke(drag.found, session.strokeOptions(kMousePress_mm), events.front().place_px, events.front().time_s));
  for (std::size_t k = 1; k < events.size(); ++k) {
    if (k + 1 < events.size())
      session.stroke()->moveTo(events[k].place_px, events[k].time_s);
    else
      session.stroke()->release(events[k].time_s);
    session.drawUntil(events[k].time_s);
    goOn(events[k].time_s - events[k - 1].time_s);
  }
  for (int frame = 0; session.isDrawing() && frame < kMaxFrames; ++frame) {
    session.drawUntil(events.back().time_s);
    goOn(kFrame_s);
  }
  const std::size_t end = session.recentTicks().rows().size();
  goOn(kAfter_s);
  for (std::size_t k = first; k < end; ++k) hips.push_back(session.recentTicks().rows()[k].hip - model.cloud.origin);
  return {session.history().points().begin(), session.history().points().end()};
}

StrokeModel::StrokeModel(Context& context, const std::string& file, EstimateOn where)
    : name_(std::filesystem::path(file).stem().string()),
      model_(capped(context, loadModel(context, {.file = file}, where))),
      surface_(model_.cloud, kWalkedPoints),
      judge_(model_.cloud) {}

std::uint32_t StrokeModel::nearestTo(const DVec3& place) const {
  std::array<std::uint32_t, 1> nearest{};
  std::array<double, 1> squared{};
  judge_.tree().nearest(Vec3(place), nearest, squared);
  return nearest[0];
}

StrokeModel::Place StrokeModel::placeAt(std::uint32_t point, double radius_mm) {
  const DVec3 p(model_.cloud.positions[point]), n(model_.cloud.normals[point]);
  const double radius = model_.scale.toUnits(radius_mm), h = judge_.spacingAt(p, n);
  found_.clear();
  judge_.tree().near(p, 2 * radius, found_);
  Place place{.kind = "flat", .spot = {.position = p, .normal = n}};
  double thickness = kNoSide, gap = kNoSide;
  std::size_t turned = 0, near = 0;
  double over = 0;
  std::vector<double> angles;
  const Frame3 frame = frameAround(n);
  for (const std::uint32_t i : found_) {
    const DVec3 offset = DVec3(model_.cloud.positions[i]) - p;
    const double up = glm::dot(offset, n), side = glm::length(offset - up * n);
    const double facing = glm::dot(DVec3(model_.cloud.normals[i]), n);
    if (facing < -0.5 && side < std::max(1.5 * h, 0.2 * radius)) {
      if (up < 0) thickness = std::min(thickness, -up);
      if (up > 0.5 * h) gap = std::min(gap, up);
    }
    const double distance = glm::length(offset);
    if (distance < 4 * h && facing > 0.3 && side > 0)
      angles.push_back(std::atan2(glm::dot(offset, frame.u), glm::dot(offset, frame.v)));
    if (distance > radius || facing < -0.5) continue;
    ++near;
    if (facing < 0.4) {
      ++turned;
      over += up > 0 ? 1 : -1;
    }
  }
  std::ranges::sort(angles);
  double widest = angles.empty() ? 2 * std::numbers::pi : angles.front() + 2 * std::numbers::pi - angles.back();
  for (std::size_t k = 1; k < angles.size(); ++k) widest = std::max(widest, angles[k] - angles[k - 1]);
  place.thickness_mm = model_.scale.toMm(thickness);
  const bool turns = turned > 4 && 10 * turned > near;
  if (widest > 2.4)
    place.kind = "border";
  else if (thickness < 2 * radius)
    place.kind = "thin";
  else if (gap < 2 * radius || (turns && over > 0))
    place.kind = "fold";
  else if (turns)
    place.kind = "edge";
  return place;
}

PlannedStroke planStroke(StrokeModel& subject, std::span<const std::string> brushes, std::uint64_t seed,
                         std::size_t number, bool byMouse) {
  Dice random(seed, number);
  PlannedStroke plan;
  StrokeResult& result = plan.result;
  result.number = number;
  result.subject = subject.name();
  result.brush = brushes[static_cast<std::size_t>(random() * static_cast<double>(brushes.size()))];
  result.config.kind = *valueNamed(kBrushKinds, result.brush);
  result.depth_mm = kUsualDepth_mm, result.speed_mm_per_s = kUsualSpeed_mm_per_s;
  if (random() < 0.5) {
    result.config.radius_mm *= random.between(0.5, 2);
    result.depth_mm = random.between(1, 3 * result.config.radius_mm);
    result.speed_mm_per_s = random.between(5, 500);
  }
  result.drag_mm = std::max(0.0, random() * 1.2 - 0.2) * 3 * 2 * result.config.radius_mm;
  const bool odd = random() < 0.5;
  StrokeModel::Place place;
  for (std::size_t tries = 0; tries < kPlaceTries; ++tries) {
    const auto point = static_cast<std::uint32_t>(random() * static_cast<double>(subject.model().cloud.size()));
    place = subject.placeAt(point, result.config.radius_mm);
    if (!odd || place.kind == "thin" || place.kind == "fold" || place.kind == "border") break;
  }
  if (byMouse) {
    result.depth_mm = kMousePress_mm + result.config.yieldDepth_mm;
    result.drag_mm = 0;
  }
  result.start = place.spot.position;
  result.normal = place.spot.normal;
  byMouse ? planDrag(subject, random, plan) : planPath(subject, random, plan);
  if (byMouse) {
    result.start = plan.played.spots.front();
    place = subject.placeAt(subject.nearestTo(result.start), result.config.radius_mm);
  }
  result.place = place.kind;
  result.thickness_mm = place.thickness_mm;
  PlayedStroke& played = plan.played;
  played.brush = result.config.kind;
  played.radius_mm = result.config.radius_mm;
  played.depth_mm = result.depth_mm;
  played.yield_mm = result.config.yieldDepth_mm;
  played.drag_mm = result.drag_mm;
  played.isOpen = byMouse || result.place == "border" || result.place == "thin";
  played.mm_per_unit = subject.model().scale.mm_per_unit;
  return plan;
}

}  // namespace palpate
