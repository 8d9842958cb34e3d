// The pace of depth streams: which frame is due at a time, and lost and late frames.
#include "engine/motion/depth_player.hpp"

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <thread>

#include "engine/core/error.hpp"
#include "engine/motion/depth_source.hpp"
#include "tests/motion/depth_stream.hpp"
#include "tests/near.hpp"

namespace palpate::depth_player_test {

namespace {

const std::vector<double> kTimes_s{0, 0.1, 0.2, 0.35, 0.4};
constexpr double kPeriod_s = 0.5;  // 0.4 and the mean interval

std::shared_ptr<DepthStream> recorded(std::set<std::uint64_t> lost = {}) {
  return std::make_shared<RecordedStream>(kTimes_s, std::move(lost));
}

/// Independent reference: the last readable frame up to that time, or the first one.
std::uint64_t dueAt(double stream_s, const std::set<std::uint64_t>& lost, bool loops) {
  double pass_s = stream_s;
  if (loops && stream_s >= 0) pass_s -= kPeriod_s * std::floor(stream_s / kPeriod_s);
  std::uint64_t due = 0;
  while (lost.contains(due)) ++due;
  for (std::uint64_t k = 0; k < kTimes_s.size(); ++k)
    if (!lost.contains(k) && kTimes_s[k] <= pass_s) due = std::max(due, k);
  return due;
}

/// Frames with poses, except for those in `poseless`; the camera moves along x.
class PosedStream final : public DepthStream {
 public:
  explicit PosedStream(std::set<std::uint64_t> poseless) : poseless_(std::move(poseless)) {}
  const DepthCamera& camera() const override { return frames_.camera(); }
  bool next(DepthFrame& frame) override {
    if (!frames_.next(frame)) return false;
    frame.pose.reset();
    if (!poseless_.contains(frame.number)) frame.pose = {.centre = {static_cast<double>(frame.number), 0, 0}};
    return true;
  }
  bool isRecorded() const override { return true; }
  void rewind() override { frames_.rewind(); }
  std::uint64_t frames() const override { return frames_.frames(); }
  double duration_s() const override { return frames_.duration_s(); }

 private:
  std::set<std::uint64_t> poseless_;
  RecordedStream frames_{kTimes_s};
};

/// Waits until the player's thread has caught up.
template <class Ready>
void until(Ready&& ready) {
  for (int guard = 0; guard < 5000 && !ready(); ++guard) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  CHECK(ready());
}

}  // namespace

TEST_CASE("in virtual time the due frame is played, forwards, backwards and with jumps") {
  for (const bool loops : {false, true})
    for (const std::set<std::uint64_t>& lost : {std::set<std::uint64_t>{}, {2}, {0}, {0, 1, 4}})
      for (const double speed : {1.0, 0.5, 3.0}) {
        CAPTURE(loops);
        CAPTURE(speed);
        DepthPlayer player(recorded(lost), {.speed = speed, .loop = loops});
        std::vector<double> asked_s;
        for (int k = 0; k < 40; ++k) asked_s.push_back(0.031 * k);
        for (const double time_s : {0.9, 0.12, 0.121, 0.05, -1.0, 0.4, 7.03, 0.0, 0.36, 0.0}) asked_s.push_back(time_s);
        for (const double time_s : asked_s) {
          CAPTURE(time_s);
          const DepthPlayer::Played played = player.frameAt(time_s);
          const std::uint64_t due = dueAt(speed * time_s, lost, loops);
          CHECK(played.frame.number == due);
          CHECK(played.frame.depth_m[5] == 1 + static_cast<float>(due));
          CHECK(played.time_s <= std::max(time_s, 0.0) + 1e-12);
        }
      }
}

TEST_CASE("a frame has the time at which it became due, whatever was requested before") {
  DepthPlayer straight(recorded(), {.speed = 2, .loop = true}), astray(recorded(), {.speed = 2, .loop = true});
  for (const double time_s : {0.7, 0.1, 0.33, 0.0}) astray.frameAt(time_s);
  for (const double time_s : {0.06, 0.11, 0.3, 0.31, 0.6}) {
    const DepthPlayer::Played one = straight.frameAt(time_s), other = astray.frameAt(time_s);
    CHECK(one.time_s == other.time_s);
    CHECK(one.serial == other.serial);
  }
  CHECK(straight.frameAt(0.11).time_s == near(0.1, 1e-6));
  CHECK(straight.frameAt(0.31).time_s == near(0.3, 1e-6));  // in the second pass, whose first frame was due at 0.25
}

TEST_CASE("a player reports the camera pose of its frame, and none for a frame without a pose") {
  DepthPlayer player(std::make_shared<PosedStream>(std::set<std::uint64_t>{2}));
  CHECK_FALSE(player.view());
  for (const double time_s : {0.0, 0.15, 0.4, 0.36, 0.2, 0.11}) {
    CAPTURE(time_s);
    const std::uint64_t number = player.frameAt(time_s).frame.number;
    const auto view = player.view();
    REQUIRE(view.has_value() == (number != 2));
    if (!view) continue;
    CHECK(view->number == number);
    CHECK(view->frustum == frustumOf(kTinyCamera, {.centre = {static_cast<double>(number), 0, 0}}));
  }
}

TEST_CASE("lost frames are counted with the last reason, and a stream without any readable frame is an error") {
  DepthPlayer player(recorded({1, 3}));
  CHECK(player.frameAt(0.36).frame.number == 2);
  until([&] { return player.counts().lost == 2; });
  CHECK(player.counts().lastLoss == "frame 3 is torn");
  CHECK(player.counts().dropped == 0);
  CHECK_FALSE(player.counts().silentSince_s.has_value());
  for (const bool loops : {false, true}) {
    DepthPlayer none(recorded({0, 1, 2, 3, 4}), {.loop = loops});
    CHECK_THROWS_WITH_AS(none.frameAt(0), "no frame of the depth stream could be read; the last one: frame 4 is torn",
                         Error);
    CHECK_THROWS_AS(none.frameAt(0.3), Error);
  }
}

TEST_CASE("a paused player keeps its frame, steps to the next one, and continues playing from there") {
  DepthPlayer player(recorded());
  CHECK(player.frameAt(0.15).frame.number == 1);
  player.pause(0.15);
  CHECK(player.frameAt(3).frame.number == 1);
  player.step();
  CHECK(player.frameAt(3).frame.number == 2);
  player.step();
  CHECK(player.frameAt(4).frame.number == 3);
  player.play(10);
  CHECK(player.frameAt(10.04).frame.number == 3);
  CHECK(player.frameAt(10.06).frame.number == 4);
  player.pause(11);
  player.step();
  CHECK(player.frameAt(12).frame.number == 4);
}

TEST_CASE("a new speed applies from the present time on") {
  DepthPlayer player(recorded());
  CHECK(player.frameAt(0.2).frame.number == 2);
  player.setSpeed(0.1, 0.2);
  CHECK(player.frameAt(1.6).frame.number == 2);
  CHECK(player.frameAt(1.8).frame.number == 3);
}

TEST_CASE("in real time late frames are dropped and counted, and only the first frame is waited for") {
  std::vector<double> times_s;
  for (int k = 0; k < 1000; ++k) times_s.push_back(0.01 * k);
  DepthPlayer player(std::make_shared<RecordedStream>(times_s), {.exact = false});
  CHECK(player.frameAt(0).frame.number == 0);
  until([&] { return player.frameAt(5).frame.number >= 499; });
  const PlayCounts counts = player.counts();
  CHECK(player.frameAt(5).frame.number <= 500);
  CHECK(counts.dropped > 400);
  CHECK(counts.dropped + counts.played <= 502);
}

TEST_CASE("the newest frame of a live stream is played, and earlier ones are dropped") {
  const auto stream = std::make_shared<LiveStream>();
  DepthPlayer player(stream, {}, tinyFrame(0, 20));
  CHECK(player.frameAt(0.5).frame.number == 0);
  CHECK(player.frameAt(0.6).frame.number == 0);
  for (std::uint64_t k = 1; k <= 9; ++k) stream->give(tinyFrame(k, 20 + 0.1 * static_cast<double>(k)));
  until([&] { return player.frameAt(1).frame.number == 9; });
  CHECK(player.counts().dropped + player.counts().played == 10);
  CHECK(player.frameAt(1).time_s <= 1);
  CHECK_FALSE(player.counts().silentSince_s.has_value());
}

TEST_CASE("a live stream that stops or ends keeps its last frame and reports since when") {
  const auto stream = std::make_shared<LiveStream>();
  DepthPlayer player(stream, {}, tinyFrame(0, 0));
  CHECK(player.frameAt(2).frame.number == 0);
  CHECK(player.frameAt(2.9).frame.number == 0);
  CHECK_FALSE(player.counts().silentSince_s.has_value());
  player.frameAt(3.1);
  CHECK(player.counts().silentSince_s == 2.0);
  stream->give(tinyFrame(1, 1));
  until([&] { return player.frameAt(4).frame.number == 1; });
  CHECK_FALSE(player.counts().silentSince_s.has_value());
  stream->end();
  until([&] { return player.counts().silentSince_s == 4.0; });
  CHECK(player.frameAt(100).frame.number == 1);
  const auto ended = std::make_shared<LiveStream>();
  ended->end();
  DepthPlayer none(ended);
  CHECK_THROWS_WITH_AS(none.frameAt(0), "the depth stream ended before its first frame", Error);
}

TEST_CASE("a paused live stream does not count as silent, and counts from its resumption") {
  const auto stream = std::make_shared<LiveStream>();
  DepthPlayer player(stream, {}, tinyFrame(0, 0));
  CHECK(player.frameAt(2).frame.number == 0);
  player.pause(2.5);
  for (const double time_s : {2.5, 4.0, 60.0}) {
    player.frameAt(time_s);
    CHECK_FALSE(player.counts().silentSince_s.has_value());
  }
  // While a session sculpts it does not query the player, and its time may differ afterwards.
  for (const double goesOn_s : {200.0, 0.5}) {
    CAPTURE(goesOn_s);
    player.play(goesOn_s);
    player.frameAt(goesOn_s + 0.9);
    CHECK_FALSE(player.counts().silentSince_s.has_value());
    player.frameAt(goesOn_s + 1.1);
    CHECK(player.counts().silentSince_s == goesOn_s);
    player.pause(goesOn_s + 1.1);
  }
}

namespace {

/// Numbers of the frames that nextDue() returns up to a time.
std::vector<std::uint64_t> handedOut(DepthPlayer& player, double time_s) {
  std::vector<std::uint64_t> numbers;
  while (const auto played = player.nextDue(time_s)) {
    CHECK(played->frame.depth_m[5] == 1 + static_cast<float>(played->frame.number));
    CHECK(played->time_s <= std::max(time_s, 0.0) + 1e-12);
    numbers.push_back(played->frame.number);
  }
  return numbers;
}

using Numbers = std::vector<std::uint64_t>;

}  // namespace

TEST_CASE("due frames are returned in order, each once, however far the time advances") {
  for (const double speed : {1.0, 2.0}) {
    DepthPlayer player(recorded({3}), {.speed = speed});
    CHECK(handedOut(player, 0.05 / speed) == Numbers{0});
    CHECK(handedOut(player, 0.05 / speed).empty());
    CHECK(handedOut(player, 0.25 / speed) == Numbers{1, 2});
    CHECK(handedOut(player, 9) == Numbers{4});
    CHECK(handedOut(player, 10).empty());
    CHECK(player.counts().played == 4);
    CHECK(player.counts().dropped == 0);
    const DepthPlayer::Losses losses = player.takeLosses();
    CHECK(losses.frames == 1);
    CHECK(losses.why == "frame 3 is torn");
    CHECK(player.takeLosses().frames == 0);
  }
}

TEST_CASE("a loop returns every frame of each pass, and starts over when time goes back") {
  DepthPlayer player(recorded(), {.loop = true});
  CHECK(handedOut(player, 1.15) == Numbers{0, 1, 2, 3, 4, 0, 1, 2, 3, 4, 0, 1});
  CHECK_FALSE(player.rewindFor(1.12));
  CHECK(player.rewindFor(0.65));
  CHECK_FALSE(player.rewindFor(0.65));
  CHECK(handedOut(player, 0.65) == Numbers{0, 1, 2, 3, 4, 0, 1});
  CHECK(handedOut(player, 0) == Numbers{0});
}

TEST_CASE("in real time the newest due frame is returned, and the frames before it are dropped") {
  std::vector<double> times_s;
  for (int k = 0; k < 500; ++k) times_s.push_back(0.01 * k);
  DepthPlayer player(std::make_shared<RecordedStream>(times_s), {.exact = false});
  CHECK(player.nextDue(0)->frame.number == 0);
  std::uint64_t last = 0, played = 1;
  until([&] {
    if (const auto next = player.nextDue(3)) {
      CHECK(next->frame.number > last);
      last = next->frame.number;
      ++played;
    }
    return last == 300;
  });
  CHECK_FALSE(player.nextDue(3).has_value());
  CHECK(player.counts().played == played);
  CHECK(player.counts().played + player.counts().dropped == 301);
}

TEST_CASE("frames up to the starting point are skipped, also after time goes back") {
  DepthPlayer player(recorded());
  player.beginBehind({.pass = 0, .time_s = 0.1});
  CHECK(handedOut(player, 0.15).empty());
  CHECK_FALSE(player.rewindFor(0));
  CHECK(handedOut(player, 0.36) == Numbers{2, 3});
  CHECK(player.counts().played == 3);
  CHECK(player.rewindFor(0.05));
  CHECK(handedOut(player, 0.05).empty());
  CHECK(handedOut(player, 0.2) == Numbers{2});
  player.beginHere();
  CHECK_FALSE(player.rewindFor(0.1));
  CHECK(handedOut(player, 0.4) == Numbers{3, 4});
  CHECK(player.rewindFor(0.3));
  CHECK(handedOut(player, 0.36) == Numbers{3});
}

TEST_CASE("a held player continues in the time of its next owner") {
  DepthPlayer player(recorded());
  CHECK(handedOut(player, 0.2) == Numbers{0, 1, 2});
  player.hold(0.36);
  player.beginHere();
  CHECK(handedOut(player, 0).empty());
  CHECK(handedOut(player, 50).empty());
  player.play(100);
  CHECK(handedOut(player, 100.14).empty());
  CHECK(handedOut(player, 100.16) == Numbers{3});
  CHECK(handedOut(player, 100.21) == Numbers{4});
  player.leaveOut("it cannot be placed");
  CHECK(player.counts().played == 4);
  CHECK(player.counts().lost == 1);
  CHECK(player.counts().lastLoss == "it cannot be placed");
}

TEST_CASE("a live frame read in advance counts as present, and newer ones are returned") {
  const auto stream = std::make_shared<LiveStream>();
  DepthPlayer player(stream, {.exact = false}, tinyFrame(0, 20));
  CHECK_FALSE(player.nextDue(1).has_value());
  stream->give(tinyFrame(1, 20.1));
  std::uint64_t number = 0;
  until([&] {
    if (const auto next = player.nextDue(2)) number = next->frame.number;
    return number == 1;
  });
  CHECK(player.counts().played == 2);
}

TEST_CASE("destroying a player ends its pending read") {
  for (int k = 0; k < 20; ++k) {
    const auto stream = std::make_shared<LiveStream>();
    {
      DepthPlayer player(stream);
      if (k % 2 == 0) stream->give(tinyFrame(0, 0));
      if (k % 2 == 0) player.frameAt(0);
    }
    CHECK(stream.use_count() == 1);  // no thread of the player still reads from it
  }
}

TEST_CASE("a source makes the points of the due frame, the same bit by bit for the same time") {
  DepthSource source(playedStream(recorded())), other(playedStream(recorded()));
  CHECK(source.size() == 12);
  CHECK_FALSE(source.keepsPoints());
  CloudFrame frame, again;
  CHECK(source.hasNewer(0.25, 0));
  source.makeFrame(0.25, frame);
  CHECK(frame.size() == 12);
  CHECK(frame.time_s == 0.25);       // blended from there to the depths of this frame
  CHECK(frame.positions[0].z == 3);  // a metre from the last frame: a different surface
  CHECK_FALSE(source.hasNewer(0.34, frame.time_s));
  CHECK(source.hasNewer(0.36, frame.time_s));
  CHECK(source.hasNewer(0.1, frame.time_s));
  for (const double time_s : {0.4, 0.0, 0.3}) other.makeFrame(time_s, again);
  other.makeFrame(0.22, again);
  CHECK(again.positions == frame.positions);
  CHECK(again.normals == frame.normals);
  CHECK(again.time_s == 0.22);
  DepthSource shifted(playedStream(recorded()), DVec3(0, 0, 1));
  shifted.makeFrame(0.25, again);
  CHECK(again.positions[0].z == 2);
}

}  // namespace palpate::depth_player_test
