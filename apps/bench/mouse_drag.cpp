#include "apps/bench/mouse_drag.hpp"

#include <algorithm>
#include <cmath>

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

}  // namespace palpate
