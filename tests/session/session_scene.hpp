// A sphere as a session's model, and hands that follow paths over it.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "haptics/devices/path_device.hpp"
#include "haptics/devices/replay_device.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/session_header.hpp"
#include "tests/scenes.hpp"

namespace palpate {

inline Model sphereModel(std::size_t points = 4'000) {
  const Scene scene = makeScene("sphere", points);
  return {.cloud = scene.cloud, .scale = {1}, .spacing = scene.spacing, .wideSpacing = scene.spacing};
}

/// Onto the sphere of radius 50 from a direction, `depth` into it, along it for a while, and away.
inline Path strokeFrom(const DVec3& direction, double depth, double duration_s = 0.2) {
  const DVec3 out = glm::normalize(direction), along = glm::normalize(glm::cross(out, DVec3(0.3, 0.5, 0.9)));
  const auto at = [&](double r, double turn) { return r * glm::normalize(out + turn * along); };
  return Path({{0, at(52, 0)},
               {0.3 * duration_s, at(50 - depth, 0.02)},
               {0.8 * duration_s, at(50 - depth, 0.2)},
               {duration_s, at(53, 0.22)}});
}

/// A path as a session's device and hand.
class PathHand {
 public:
  explicit PathHand(Path path)
      : duration_s_(path.duration_s()), device_(std::make_unique<PathDevice>(std::move(path))) {}
  OpenHand hand() const { return {.device = device_.get(), .duration_s = duration_s_}; }

 private:
  double duration_s_;
  std::unique_ptr<PathDevice> device_;
};

inline ServoResult runAlone(Session& session, Path path, const RunOptions& options = {}) {
  const PathHand hand(std::move(path));
  const OpenHand open = hand.hand();
  return session.run({&open, 1}, options);
}

/// Runs to the end and records a log.
inline ServoResult runRecorded(Session& session, const std::string& log, Path path) {
  const PathHand hand(std::move(path));
  const OpenHand open = hand.hand();
  session.record(log, open);
  ServoResult result = session.run({&open, 1}, {});
  session.finish();
  session.endRecording();
  return result;
}

/// Replays a log with the recorded hand.
inline ServoResult runAgain(Session& session, SessionRecord record, const RecordedSession& recorded) {
  const double duration_s = record.ticks.back().time_s;
  ReplayDevice device(std::move(record.ticks), recorded.limits);
  const OpenHand hand{.device = &device, .map = recorded.map, .duration_s = duration_s};
  return session.run({&hand, 1}, {});
}

inline bool sameTrace(const Trace& a, const Trace& b) {
  return std::ranges::equal(a.rows, b.rows, [](const TraceRow& x, const TraceRow& y) {
    return x.time_s == y.time_s && x.hip == y.hip && x.proxy == y.proxy && x.force_N == y.force_N &&
           x.contact == y.contact && x.neighbours == y.neighbours && x.valid == y.valid;
  });
}

}  // namespace palpate
