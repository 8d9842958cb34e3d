// A depth stream as a cloud that moves.
#include "engine/motion/fused_source.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <thread>

#include "engine/core/error.hpp"
#include "engine/motion/fused_playback.hpp"
#include "tests/motion/depth_scene.hpp"

namespace palpate {

namespace {

enum class Kind { recorded, live };

// Frames 0.1 s apart, of which one cannot be read.
class FewFrames final : public DepthStream {
 public:
  FewFrames(Kind kind, std::size_t broken) : kind_(kind), broken_(broken), camera_(smallCamera()) {
    const DepthScene scene = tableScene();
    for (std::uint64_t i = 0; i < 6; ++i) {
      const CameraPose pose = onArc(DVec3(0, 0, 0.02), 1.0, 0.2 * static_cast<double>(i));
      frames_.push_back(scene.frame(camera_, pose, 1, i));
      frames_.back().time_s = 0.1 * static_cast<double>(i);
      frames_.back().colors.assign(frames_.back().depth_m.size(), {10, 20, 30});
    }
  }

  const DepthCamera& camera() const override { return camera_; }
  bool next(DepthFrame& frame) override {
    if (at_ == frames_.size()) return false;
    if (at_++ == broken_) throw Error("frame {}: it is torn", broken_);
    frame = frames_[at_ - 1];
    return true;
  }
  bool isRecorded() const override { return kind_ == Kind::recorded; }
  void rewind() override { at_ = 0; }

 private:
  Kind kind_;
  std::size_t broken_, at_ = 0;
  DepthCamera camera_;
  std::vector<DepthFrame> frames_;
};

bool areEqual(const CloudFrame& a, const CloudFrame& b) {
  return a.time_s == b.time_s && a.positions == b.positions && a.normals == b.normals && a.ids == b.ids &&
         a.colors == b.colors;
}

}  // namespace

TEST_CASE("the same time gives the same points, whatever was asked for before") {
  FewFrames stream(Kind::recorded, 99);
  FusedSource source(unowned(stream), smallMap(50'000));
  CHECK(source.size() == 50'000);
  CHECK(source.keepsPoints());
  CloudFrame first, later, again;
  source.makeFrame(0.25, first);
  CHECK(first.time_s == doctest::Approx(0.2));
  CHECK(source.fusion().fused() == 3);
  CHECK(first.positions.size() == source.fusion().map().count());
  CHECK(first.ids.size() == first.positions.size());
  CHECK(first.positions.size() <= source.size());
  CHECK(first.normals.size() == first.positions.size());
  CHECK(first.colors.size() == first.positions.size());
  source.makeFrame(9, later);
  CHECK(later.time_s == doctest::Approx(0.5));
  CHECK(later.positions.size() > first.positions.size());
  source.makeFrame(0.25, again);
  CHECK(areEqual(first, again));
  source.makeFrame(0, again);
  CHECK(source.fusion().fused() == 1);
}

TEST_CASE("a frame that cannot be read is counted as lost, and the next ones come") {
  FewFrames stream(Kind::recorded, 2);
  FusedSource source(unowned(stream), smallMap());
  CloudFrame frame;
  source.makeFrame(1, frame);
  CHECK(source.fusion().fused() == 5);
  CHECK(source.fusion().lost() == 1);
}

TEST_CASE("a live camera's newest frame is fused once, and its end keeps the map") {
  FewFrames stream(Kind::live, 99);
  FusedPlayback source(unowned(stream), {.exact = false}, smallMap());
  CloudFrame frame;
  source.makeFrame(0, frame);
  CHECK(frame.size() > 1'000);
  CHECK(frame.ids.size() == frame.size());
  CHECK(frame.colors.size() == frame.size());
  for (int i = 0; i < 500 && source.playCounts()->played + source.playCounts()->dropped < 6; ++i) {
    source.makeFrame(0.01 * i, frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const PlayCounts counts = *source.playCounts();
  CHECK(counts.played + counts.dropped == 6);
  CHECK(source.fused() == counts.played);
  const CloudFrame last = frame;
  CHECK_FALSE(source.hasNewer(9, frame.time_s));
  source.makeFrame(9, frame);
  CHECK(areEqual(last, frame));
}

TEST_CASE("a recording that is played fuses the frame that is due, and each one once") {
  FewFrames stream(Kind::recorded, 2);
  FusedPlayback source(unowned(stream), {}, smallMap());
  CloudFrame frame;
  for (int i = 0; i <= 60; ++i) {
    source.makeFrame(0.01 * i, frame);
    CHECK(frame.time_s <= 0.01 * i + 1e-9);
  }
  CHECK(source.fused() == 5);
  CHECK(source.playCounts()->lost == 1);
  FewFrames again(Kind::recorded, 2);
  FusedSource whole(unowned(again), smallMap());
  CloudFrame truth;
  whole.makeFrame(0.6, truth);
  CHECK(frame.positions == truth.positions);
  CHECK(frame.ids == truth.ids);
}

TEST_CASE("a frame has the points that there are, by their ids") {
  DepthScene near, far;
  near.add("cube", 0.2, {0, 0, 0.1});
  far.add("plane", 2, {0, 0, -0.5});
  class Leaves final : public DepthStream {
   public:
    Leaves(const DepthScene& near, const DepthScene& far) : camera_(smallCamera()) {
      const CameraPose pose = lookingAt({0, 0, 1}, {0, 0, 0});
      near_ = near.frame(camera_, pose);
      far_ = far.frame(camera_, pose);
    }
    const DepthCamera& camera() const override { return camera_; }
    bool next(DepthFrame& frame) override {
      frame = at_ < 5 ? near_ : far_;
      return at_++ < 12;
    }
    bool isRecorded() const override { return true; }
    void rewind() override { at_ = 0; }

   private:
    DepthCamera camera_;
    DepthFrame near_, far_;
    int at_ = 0;
  } stream(near, far);
  FusedSource source(unowned(stream), smallMap());
  CloudFrame frame;
  source.makeFrame(1, frame);
  const SurfelMap& map = source.fusion().map();
  CHECK(frame.size() == map.count());
  CHECK(frame.size() < map.ids());
  std::size_t right = 0;
  for (std::size_t i = 0; i < frame.size(); ++i)
    right += map.holds(frame.ids[i]) && frame.positions[i] == map.surfel(frame.ids[i]).place &&
             glm::length(frame.normals[i]) > 0.99f;
  CHECK(right == frame.size());
}

}  // namespace palpate
