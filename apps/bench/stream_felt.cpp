#include "apps/bench/stream_felt.hpp"

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <thread>

#include "apps/bench/bench.hpp"
#include "engine/render/frame.hpp"
#include "haptics/devices/path_device.hpp"
#include "haptics/session/drawn_follower.hpp"

namespace palpate {

namespace {

constexpr double kCameraRate_Hz = 30;
constexpr std::uint32_t kWidth_px = 1920, kHeight_px = 1080;
constexpr double kPressed_m = 0.005, kAside_rad = 0.05, kStroke_s = 2;

// Repeats the frames in a cycle, paced by the clock as from a camera.
class PacedFrames final : public DepthStream {
 public:
  PacedFrames(const DepthCamera& camera, const std::vector<DepthFrame>& frames) : camera_(camera), frames_(frames) {}

  const DepthCamera& camera() const override { return camera_; }
  bool next(DepthFrame& frame) override {
    std::unique_lock lock(mutex_);
    const auto due = begin_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                  std::chrono::duration<double>(static_cast<double>(number_) / kCameraRate_Hz));
    if (changed_.wait_until(lock, due, [this] { return stopped_; })) return false;
    frame = frames_[number_ % frames_.size()];
    frame.number = number_;
    frame.time_s = static_cast<double>(number_++) / kCameraRate_Hz;
    return true;
  }
  void stop() noexcept override {
    const std::scoped_lock lock(mutex_);
    stopped_ = true;
    changed_.notify_all();
  }
  bool isRecorded() const override { return false; }
  void rewind() override {}

 private:
  DepthCamera camera_;
  const std::vector<DepthFrame>& frames_;
  const std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
  std::uint64_t number_ = 0;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopped_ = false;
};

// Draws the session's cloud, one picture after another, on its own thread.
class Drawing {
 public:
  Drawing(Device& device, Session& session)
      : device_(device),
        follower_(device, session.model(), session.backend()),
        frame_(device, kWidth_px, kHeight_px, 1),
        camera_(Camera::fitting(session.model().cloud, double{kWidth_px} / kHeight_px, 45, {})),
        list_(device, device.throughputQueue(), "frame") {
    draw();  // pipelines are created at their first use
    thread_ = std::jthread([this](const std::stop_token& stop) {
      try {
        const Stopwatch watch;
        for (; !stop.stop_requested(); ++pictures_) draw();
        duration_s_ = watch.elapsed_s();
      } catch (...) {
        failure_ = std::current_exception();
      }
    });
  }
  // Rethrows the thread's exception.
  void end() {
    thread_ = {};
    if (failure_) std::rethrow_exception(failure_);
  }
  double pictures_per_s() const { return static_cast<double>(pictures_) / duration_s_; }
  std::uint64_t frames() const { return follower_.frames(); }

 private:
  void draw() {
    follower_.catchUp({});
    follower_.drawn().closeSurface();
    list_.begin();
    frame_.record(list_, follower_.drawn(), camera_, {});
    list_.end();
    device_.throughputQueue().run(list_);
  }

  Device& device_;
  DrawnFollower follower_;
  Frame frame_;
  Camera camera_;
  CommandList list_;
  std::uint64_t pictures_ = 0;
  double duration_s_ = 0;
  std::exception_ptr failure_;
  std::jthread thread_;  // destroyed first
};

// Strokes back and forth over the area that the camera sees, slightly below the surface.
Path strokesOver(const FeltScene& scene) {
  const auto at = [&](double radius, double angle) { return radius * DVec3(std::sin(angle), 0, -std::cos(angle)); };
  const double pressed = scene.radius_m - kPressed_m;
  std::vector<PathKey> keys{{0, at(scene.radius_m + 4 * kPressed_m, -kAside_rad)}};
  double side = -kAside_rad;
  for (double t_s = 0.5; t_s < scene.duration_s + kStroke_s; t_s += kStroke_s, side = -side)
    keys.push_back({t_s, at(pressed, side)});
  return Path(std::move(keys));
}

FeltStream feel(Context& context, const FeltScene& scene, const std::string& situation) {
  SessionConfig config{.model = {.file = "-", .mm_per_unit = 1000},
                       .backend = {.name = "vulkan"},
                       .duration_s = scene.duration_s,
                       .realtime = true};
  Model model{.cloud = scene.map, .scale = {1000}, .spacing = scene.spacing_m, .wideSpacing = scene.spacing_m};
  if (situation != "still") {
    config.model.stream = StreamConfig{.live = true, .fuse = situation == "fused"};
    model.source =
        CameraPoints{playedStream(std::make_shared<PacedFrames>(scene.camera, scene.frames), {.exact = false})};
  }
  if (situation == "latest") {  // the latest frame has as many points as the camera has pixels
    model.cloud.positions.resize(std::min<std::size_t>(scene.frames.front().depth_m.size(), model.cloud.size()));
    model.cloud.normals.resize(model.cloud.positions.size());
  }
  Session session(config, std::move(model),
                  {.backend = context.backends().named("vulkan"), .threads = context.threads()});
  Drawing drawing(context.device(), session);
  PathDevice device(strokesOver(scene));
  const OpenHand hand{.device = &device, .duration_s = scene.duration_s};
  const ServoResult result = session.run({&hand, 1}, {});
  drawing.end();
  session.finish();
  const TraceSummary trace = summarize(result.trace());
  const PlayCounts counts = session.playCounts().value_or(PlayCounts{});
  return {.situation = situation,
          .ticks = trace.ticks,
          .contactTicks = trace.contactTicks,
          .missedTicks = trace.missedTicks,
          .freshShare = trace.freshFraction,
          .step_us = trace.step_us,
          .frames = counts.played,
          .framesDropped = counts.dropped,
          .pictures_per_s = drawing.pictures_per_s(),
          .framesDrawn = drawing.frames(),
          .framesOf = scene.framesOf,
          .surfels = scene.map.size()};
}

}  // namespace

std::vector<FeltStream> feelStreams(Context& context, const FeltScene& scene) {
  std::vector<FeltStream> all;
  for (const std::string situation : {"still", "latest", "fused"}) {
    context.log().say("stream: {} points, {}, felt for {:g} s", scene.map.size(), situation, scene.duration_s);
    all.push_back(feel(context, scene, situation));
  }
  return all;
}

}  // namespace palpate
