// A depth stream as a moving cloud.
#include "engine/motion/fused_source.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <thread>
#include <utility>

#include "engine/core/error.hpp"
#include "tests/motion/depth_scene.hpp"
#include "tests/near.hpp"

namespace palpate::fused_source_test {

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
  std::uint64_t frames() const override { return frames_.size(); }
  double duration_s() const override { return frames_.back().time_s; }
  DepthFrame& at(std::size_t frame) { return frames_[frame]; }

 private:
  Kind kind_;
  std::size_t broken_, at_ = 0;
  DepthCamera camera_;
  std::vector<DepthFrame> frames_;
};

FusedStream fused(DepthStream& stream, const PlayOptions& play = {}, std::size_t capacity = 200'000) {
  return {.stream = playedStream(unowned(stream), play), .begin = nullptr, .options = smallMap(capacity)};
}

/// The map made of the first frame.
std::shared_ptr<const PointCloud> firstMap(const DepthStream& stream, const DepthFrame& frame) {
  FrameFusion fusion(smallMap());
  REQUIRE(fusion.fuse(stream.camera(), frame).fate == FrameFate::fused);
  return std::make_shared<PointCloud>(fusion.map().cloud());
}

bool areEqual(const CloudFrame& a, const CloudFrame& b) {
  return a.time_s == b.time_s && a.positions == b.positions && a.normals == b.normals && a.ids == b.ids &&
         a.colors == b.colors;
}

}  // namespace

TEST_CASE("a fused source gives the same points at the same time, whatever was requested before") {
  FewFrames stream(Kind::recorded, 99);
  FusedSource source(fused(stream, {}, 50'000));
  CHECK(source.size() == 50'000);
  CHECK(source.keepsPoints());
  CloudFrame first, later, again;
  source.makeFrame(0.25, first);
  CHECK(first.time_s == near(0.2, 1e-6));
  CHECK(source.fusion().fused() == 3);
  CHECK(first.positions.size() == source.fusion().map().count());
  CHECK(first.ids.size() == first.positions.size());
  CHECK(first.positions.size() <= source.size());
  CHECK(first.normals.size() == first.positions.size());
  CHECK(first.colors.size() == first.positions.size());
  source.makeFrame(9, later);
  CHECK(later.time_s == near(0.5, 1e-6));
  CHECK(later.positions.size() > first.positions.size());
  source.makeFrame(0.25, again);
  CHECK(areEqual(first, again));
  source.makeFrame(0, again);
  CHECK(source.fusion().fused() == 1);
}

TEST_CASE("a frame that cannot be read counts as lost, and the next ones are fused") {
  FewFrames stream(Kind::recorded, 2);
  FusedSource source(fused(stream));
  CloudFrame frame;
  source.makeFrame(1, frame);
  CHECK(source.fusion().fused() == 5);
  CHECK(source.fusion().lost() == 1);
}

TEST_CASE("a live camera's newest frame is fused once, and the map remains when the stream ends") {
  FewFrames stream(Kind::live, 99);
  FusedStream frames = fused(stream, {.exact = false});
  FusedSource source(frames);
  const DepthPlayer& player = *frames.stream->player;
  CloudFrame frame;
  source.makeFrame(0, frame);
  CHECK(frame.size() > 1'000);
  CHECK(frame.ids.size() == frame.size());
  CHECK(frame.colors.size() == frame.size());
  for (int i = 0; i < 500 && player.counts().played + player.counts().dropped < 6; ++i) {
    source.makeFrame(0.01 * i, frame);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const PlayCounts counts = player.counts();
  CHECK(counts.played + counts.dropped == 6);
  CHECK(source.fusion().fused() == counts.played);
  const CloudFrame last = frame;
  CHECK_FALSE(source.hasNewer(9, frame.time_s));
  source.makeFrame(9, frame);
  CHECK(areEqual(last, frame));
}

TEST_CASE("playing a recording fuses each frame once, at any speed and in a loop, for any order of requests") {
  for (const bool loops : {false, true})
    for (const double speed : {1.0, 2.5}) {
      CAPTURE(loops);
      CAPTURE(speed);
      FewFrames stream(Kind::recorded, 2), again(Kind::recorded, 2);
      const PlayOptions play{.speed = speed, .loop = loops};
      FusedStream frames = fused(stream, play);
      FusedSource source(frames), whole(fused(again, play));
      const double end_s = 0.95 / speed;  // in the second pass of 0.6 s, if it loops
      CloudFrame frame, truth;
      for (int i = 0; i <= 19; ++i) {
        source.makeFrame(end_s / 19 * i, frame);
        CHECK(frame.time_s <= end_s / 19 * i + 1e-9);
      }
      CHECK(source.fusion().fused() == (loops ? 8u : 5u));
      CHECK(frames.stream->player->counts().lost == (loops ? 2u : 1u));
      for (const double time_s : {2 * end_s, 0.0, 0.7 * end_s}) whole.makeFrame(time_s, truth);
      whole.makeFrame(end_s, truth);
      CHECK(areEqual(frame, truth));
      CHECK_FALSE(whole.hasNewer(end_s, truth.time_s));
      CHECK(whole.hasNewer(0.5 * end_s, truth.time_s));
    }
}

TEST_CASE(
    "a map begun with a cloud does not fuse its first frame twice, and restarts with the cloud when time goes back") {
  FewFrames stream(Kind::recorded, 99);
  FusedStream frames = fused(stream);
  frames.begin = firstMap(stream, stream.at(0));
  frames.stream->player->beginBehind({.pass = 0, .time_s = 0});
  FusedSource source(frames);
  CloudFrame frame, later;
  source.makeFrame(0, frame);
  CHECK(source.fusion().fused() == 0);
  CHECK(frame.positions == frames.begin->positions);
  CHECK(frame.normals == frames.begin->normals);
  CHECK(frame.colors.front() == std::array<std::uint8_t, 3>{10, 20, 30});
  CHECK(shared::isStable(source.fusion().map().surfel(0).record));
  source.makeFrame(0.25, frame);
  CHECK(source.fusion().fused() == 2);
  CHECK(frame.time_s == near(0.2, 1e-6));
  source.makeFrame(0.5, later);
  source.makeFrame(0.25, later);
  CHECK(areEqual(frame, later));
  source.makeFrame(0.05, later);
  CHECK(later.positions == frames.begin->positions);
}

TEST_CASE("a map far from zero keeps the origin of its initial cloud") {
  PointCloud cloud;
  cloud.origin = {500'000, 4'000'000, 10};
  cloud.positions = {{1, 2, 3}, {4, 5, 6}};
  cloud.normals = {{0, 0, 1}, {0, 1, 0}};
  SurfelMap map(smallMap(2));
  map.begin(cloud);
  CHECK(map.origin() == cloud.origin);
  CHECK(map.cloud().positions == cloud.positions);
  CHECK_FALSE(map.cloud().hasColors());
  cloud.positions.push_back({0, 0, 0});
  cloud.normals.push_back({0, 0, 1});
  CHECK_THROWS_WITH_AS(map.begin(cloud), "fusion: a map of 2 points at most cannot begin with 3", Error);
}

TEST_CASE("frames without poses continue from the last pose, also with a new owner of the stream") {
  FewFrames stream(Kind::recorded, 99);
  const CameraPose first = *stream.at(0).pose;
  const DepthScene scene = tableScene();
  for (std::size_t i = 0; i < 6; ++i) {
    DepthFrame frame = scene.frame(stream.camera(), onArc(DVec3(0, 0, 0.02), 1.0, 0.01 * static_cast<double>(i)), 0, i);
    frame.time_s = 0.1 * static_cast<double>(i);
    if (i == 0) frame.pose = first;
    if (i > 0) frame.pose.reset();
    stream.at(i) = frame;
  }
  FusedStream frames = fused(stream);
  frames.begin = firstMap(stream, stream.at(0));
  frames.stream->player->beginBehind({.pass = 0, .time_s = 0});
  frames.stream->seenFrom = first;
  FusedSource source(frames);
  CloudFrame frame;
  source.makeFrame(0.25, frame);
  CHECK(source.fusion().fused() == 2);
  CHECK(source.fusion().unplaced() == 0);
  frames.stream->player->pause(0.25);
  // Another source takes over the stream, with the present map.
  FusedStream next{.stream = std::make_shared<PlayedStream>(std::exchange(*frames.stream, {})),
                   .begin = std::make_shared<PointCloud>(source.fusion().map().cloud()),
                   .options = smallMap()};
  next.stream->player->beginHere();
  CHECK_FALSE(source.hasNewer(5, frame.time_s));
  CHECK(source.fusion().fused() == 2);
  FusedSource other(next);
  CloudFrame taken;
  other.makeFrame(0, taken);
  CHECK(taken.positions == frame.positions);
  next.stream->player->play(7);
  other.makeFrame(7.26, taken);
  CHECK(other.fusion().fused() == 3);
  CHECK(other.fusion().unplaced() == 0);
  CHECK(glm::distance(next.stream->seenFrom->centre, onArc(DVec3(0, 0, 0.02), 1.0, 0.05).centre) < 0.004);
}

TEST_CASE("a frame that cannot be placed counts as lost and is logged") {
  FewFrames stream(Kind::recorded, 99);
  stream.at(2).pose->centre.x = std::nan("");
  stream.at(3).depth_m.pop_back();
  struct Lines final : LogListener {
    std::vector<std::string> all;
    void said(std::string_view line) override { all.emplace_back(line); }
    void progressed(std::string_view, double) override {}
  } lines;
  Log log(true);
  log.listen(&lines);
  FusedStream frames = fused(stream);
  frames.log = &log;
  FusedSource source(frames);
  CloudFrame frame;
  source.makeFrame(1, frame);
  CHECK(source.fusion().fused() == 4);
  const PlayCounts counts = frames.stream->player->counts();
  CHECK(counts.played == 4);
  CHECK(counts.lost == 2);
  REQUIRE(lines.all.size() == 2);
  CHECK(lines.all[0].find("frame 2 is not fused: frame 2: its pose is not a rotation and position") !=
        std::string::npos);
  CHECK(counts.lastLoss.find("frame 3 has 19199 depths") != std::string::npos);
}

TEST_CASE("a frame contains the existing points by their ids") {
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
  FusedSource source(fused(stream));
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

}  // namespace palpate::fused_source_test
