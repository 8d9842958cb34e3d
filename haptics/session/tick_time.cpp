#include "haptics/session/tick_time.hpp"

#include "engine/core/clock.hpp"
#include "haptics/session/session_setup.hpp"

namespace palpate {

namespace {

constexpr std::size_t kWarmUp = 20;   // ticks at full depth that do not count, if others follow
constexpr std::size_t kFewest = 10;   // ticks at full depth, for which a slow machine gets more time
constexpr double kMaxDurations = 10;  // of that time

// One hand with the configured tool, and nothing that moves the points.
SessionConfig alone(SessionConfig config) {
  config.hands.resize(1);
  config.undo = {};
  return config;
}

Summary strokeTimes(TouchBackend& backend, SculptingHand hand, const TickTimeRequest& request) {
  std::vector<double> times_us;
  times_us.reserve(request.ticks + kWarmUp);
  Stopwatch all;  // from the first answer on, before which a driver may compile shaders
  const auto goesOn = [&] {
    const double durations = all.elapsed_s() / request.duration_s;
    return durations < 1 ? times_us.size() < request.ticks + kWarmUp
                         : durations < kMaxDurations && times_us.size() < kFewest;
  };
  for (std::uint64_t i = 0; goesOn(); ++i) {
    const bool counts = hand.sculpts();
    const Stopwatch tick;
    const double time_s = static_cast<double>(i) / request.config.rate_Hz;
    const Pose pose{.time_s = time_s, .hip = hand.read(time_s).position};
    const Contact contact = backend.ask({&pose, 1}, 0).front();
    if (!contact.valid) {
      backend.finish();  // throws the reason, if it is known
      throw Error("{} gave no valid answer", request.kind.name());
    }
    hand.felt(contact);
    backend.endTick();
    if (i == 0) all = Stopwatch();
    if (counts) times_us.push_back(tick.elapsed_us());
  }
  backend.finish();
  if (times_us.empty()) throw Error("{} felt no surface within {:.1f} s", request.kind.name(), all.elapsed_s());
  if (times_us.size() > 2 * kWarmUp) times_us.erase(times_us.begin(), times_us.begin() + kWarmUp);
  return summarize(std::move(times_us));
}

}  // namespace

std::vector<Summary> tickTimes(const TickTimeRequest& request) {
  const SessionConfig config = alone(request.config);
  const Model& model = request.model;
  const SurfaceOptions surface = request.kind.surface(model, config.surface);
  const std::optional<FusedStream> none;
  const auto backend = makeBackend({.kind = request.kind,
                                    .config = config,
                                    .model = model,
                                    .surface = surface,
                                    .threads = request.threads,
                                    .fusion = none})
                           .touch;
  backend->begin(false, {});
  backend->resetHand(0);
  std::uint64_t ticks = 0;
  for (const Stopwatch watch; watch.elapsed_s() < request.kind.warmUp_s(); ++ticks)
    backend->query({.time_s = static_cast<double>(ticks) / config.rate_Hz, .hip = request.places.front().position}, 0);
  std::vector<Summary> times;
  for (const Stroke& stroke : request.strokes) {
    if (config.brush) backend->setBrush(brushOptions(stroke.brush, model.scale));
    backend->resetHand(0);
    times.push_back(strokeTimes(
        *backend, SculptingHand(model, {request.places.begin(), request.places.end()}, stroke, surface.radius),
        request));
  }
  return times;
}

}  // namespace palpate
