// Video4Linux, with a simulated camera.
#include <doctest/doctest.h>
#include <linux/videodev2.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <deque>
#include <future>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/semaphore.hpp"
#include "engine/io/video_node.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::depth_camera_test {

namespace {

constexpr DepthCamera kCamera{.width = 3, .height = 2, .fx = 3, .fy = 3, .cx = 1, .cy = 0.5};
constexpr std::uint32_t kPitch = 8;  // two bytes longer than a row of pixels

/// State of the simulated camera, and the commands that it received.
struct FakeCamera {
  std::uint32_t capabilities = V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
  std::uint32_t format = V4L2_PIX_FMT_Z16, width = 3, height = 2;
  int formatError = 0, requestError = 0;
  std::uint32_t mostBuffers = 2;
  struct Shot {
    int error = 0;  // error of dequeuing the buffer
    std::uint32_t sequence = 0;
    double time_s = 0;
    std::uint16_t first = 0;  // depth of the first pixel; each further one is larger by one
    std::uint32_t bytes = 2 * kPitch;
    std::uint32_t flags = 0;
  };
  std::deque<Shot> shots;
  std::vector<std::vector<std::byte>> memory;
  std::vector<bool> isQueued;
  int mapped = 0, started = 0, stopped = 0, waits = 0;
  std::atomic<bool> woken = false;
  Semaphore wakes;
};

class FakeNode final : public VideoNode {
 public:
  explicit FakeNode(FakeCamera& camera) : camera_(camera) {}

  int control(unsigned long request, void* argument) noexcept override {
    switch (request) {
      case VIDIOC_QUERYCAP: {
        auto& can = *static_cast<v4l2_capability*>(argument);
        can.capabilities = V4L2_CAP_DEVICE_CAPS | V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
        can.device_caps = camera_.capabilities;
        return 0;
      }
      case VIDIOC_S_FMT:
        return setFormat(static_cast<v4l2_format*>(argument)->fmt.pix);
      case VIDIOC_ENUM_FMT: {
        auto& format = *static_cast<v4l2_fmtdesc*>(argument);
        constexpr std::uint32_t kFormats[] = {V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_MJPEG};
        if (format.index >= 2) return EINVAL;
        format.pixelformat = kFormats[format.index];
        return 0;
      }
      case VIDIOC_REQBUFS: {
        auto& buffers = *static_cast<v4l2_requestbuffers*>(argument);
        if (camera_.requestError != 0) return camera_.requestError;
        buffers.count = std::min(buffers.count, camera_.mostBuffers);
        camera_.memory.assign(buffers.count, std::vector<std::byte>(2 * kPitch));
        camera_.isQueued.assign(buffers.count, false);
        return 0;
      }
      case VIDIOC_QUERYBUF: {
        auto& buffer = *static_cast<v4l2_buffer*>(argument);
        buffer.length = 2 * kPitch;
        buffer.m.offset = 4096 * buffer.index;
        return 0;
      }
      case VIDIOC_QBUF: {
        const auto& buffer = *static_cast<v4l2_buffer*>(argument);
        if (camera_.isQueued[buffer.index]) return EINVAL;
        camera_.isQueued[buffer.index] = true;
        return 0;
      }
      case VIDIOC_DQBUF:
        return takeBuffer(*static_cast<v4l2_buffer*>(argument));
      case VIDIOC_STREAMON:
        ++camera_.started;
        return 0;
      case VIDIOC_STREAMOFF:
        ++camera_.stopped;
        return 0;
      default:
        return ENOTTY;
    }
  }
  int map(std::size_t bytes, std::int64_t offset, std::span<const std::byte>& memory) noexcept override {
    ++camera_.mapped;
    memory = std::span<const std::byte>(camera_.memory[static_cast<std::size_t>(offset) / 4096]).first(bytes);
    return 0;
  }
  void unmap(std::span<const std::byte>) noexcept override { --camera_.mapped; }
  int wait() noexcept override {
    ++camera_.waits;
    if (camera_.shots.empty() && !camera_.woken) camera_.wakes.take();
    return 0;
  }
  void wake() noexcept override {
    camera_.woken = true;
    camera_.wakes.post();
  }

 private:
  int setFormat(v4l2_pix_format& format) const {
    if (camera_.formatError != 0) return camera_.formatError;
    CHECK(format.pixelformat == V4L2_PIX_FMT_Z16);
    format.pixelformat = camera_.format;
    format.width = camera_.width;
    format.height = camera_.height;
    format.bytesperline = kPitch;
    return 0;
  }
  int takeBuffer(v4l2_buffer& buffer) {
    if (camera_.shots.empty()) return EAGAIN;
    const FakeCamera::Shot shot = camera_.shots.front();
    camera_.shots.pop_front();
    if (shot.error != 0) return shot.error;
    std::uint32_t index = 0;
    while (!camera_.isQueued.at(index)) ++index;  // a buffer is queued: each was returned
    camera_.isQueued[index] = false;
    for (std::size_t pixel = 0; pixel < 6; ++pixel) {
      const auto value = static_cast<std::uint16_t>(shot.first + pixel);
      std::memcpy(camera_.memory[index].data() + pixel / 3 * kPitch + pixel % 3 * 2, &value, 2);
    }
    buffer.index = index;
    buffer.sequence = shot.sequence;
    buffer.bytesused = shot.bytes;
    buffer.flags = shot.flags;
    buffer.timestamp.tv_sec = static_cast<long>(shot.time_s);
    buffer.timestamp.tv_usec = std::lround(1e6 * (shot.time_s - std::floor(shot.time_s)));
    return 0;
  }

  FakeCamera& camera_;
};

std::shared_ptr<DepthStream> open(FakeCamera& camera, std::optional<double> scale = {}) {
  CameraText text{.camera = kCamera};
  text.depthScale = scale;
  return streamVideoNode(std::make_unique<FakeNode>(camera), "/dev/video9", text);
}

std::string refusal(FakeCamera& camera) {
  try {
    open(camera);
  } catch (const Error& error) {
    CHECK(camera.mapped == 0);
    return error.what();
  }
  return "opened";
}

}  // namespace

TEST_CASE("V4L2 frames are read row by row, in millimetres or in the scale of the intrinsics") {
  for (const double scale : {1000.0, 5000.0}) {
    FakeCamera camera;
    camera.shots = {{.sequence = 7, .time_s = 100.5, .first = 1000},
                    {.error = EAGAIN},
                    {.sequence = 8, .time_s = 100.75, .first = 2000},
                    {.sequence = 11, .time_s = 101, .first = 0}};
    {
      const auto stream = scale == 1000 ? open(camera) : open(camera, scale);
      CHECK(camera.mapped == 2);
      CHECK(camera.started == 1);
      CHECK_FALSE(stream->isRecorded());
      DepthFrame frame;
      REQUIRE(stream->next(frame));
      CHECK(frame.time_s == 0);
      CHECK(frame.number == 0);
      REQUIRE(frame.depth_m.size() == 6);
      for (std::size_t pixel = 0; pixel < 6; ++pixel)
        CHECK(frame.depth_m[pixel] == near(static_cast<double>(1000 + pixel) / scale, 1e-6));
      REQUIRE(stream->next(frame));
      CHECK(frame.time_s == near(0.25, 1e-6));
      REQUIRE(stream->next(frame));
      CHECK(frame.number == 4);  // the driver dropped two
      CHECK(frame.depth_m[0] == 0);
      CHECK(camera.isQueued == std::vector<bool>{true, true});
    }
    CHECK(camera.waits == 1);
    CHECK(camera.stopped == 1);
    CHECK(camera.mapped == 0);
  }
}

TEST_CASE("a V4L2 device that is not a depth camera is refused with its kind") {
  FakeCamera other{.capabilities = V4L2_CAP_META_CAPTURE | V4L2_CAP_STREAMING};
  CHECK(refusal(other) == "/dev/video9: does not stream pictures; a camera has several devices, try the others");
  FakeCamera web{.format = V4L2_PIX_FMT_YUYV};
  CHECK(refusal(web) ==
        "/dev/video9: does not offer Z16, depth of 16 bits, but YUYV, MJPG; a camera has several devices, try the "
        "others");
  FakeCamera strict{.formatError = EINVAL};
  CHECK(refusal(strict) == refusal(web));
  FakeCamera larger{.width = 640, .height = 480};
  CHECK(refusal(larger) == "/dev/video9: delivers 640 x 480 pixels, but the intrinsics are for 3 x 2");
  FakeCamera busy{.formatError = EBUSY};
  CHECK(refusal(busy).find("Device or resource busy; another program uses the camera") != std::string::npos);
  FakeCamera poor{.requestError = ENOMEM};
  CHECK(refusal(poor).find("has no memory for its frames: Cannot allocate memory") != std::string::npos);
  FakeCamera none{.mostBuffers = 0};
  CHECK(refusal(none) == "/dev/video9: has no memory for its frames");
}

TEST_CASE("short, damaged and repeated V4L2 frames are dropped one by one, and their buffers returned") {
  FakeCamera camera;
  camera.shots = {{.sequence = 0, .time_s = 1, .first = 10},
                  {.sequence = 1, .time_s = 2, .bytes = 2 * kPitch - 3},
                  {.sequence = 2, .time_s = 3, .flags = V4L2_BUF_FLAG_ERROR},
                  {.sequence = 3, .time_s = 1},
                  {.sequence = 4, .time_s = 4, .first = 20, .bytes = kPitch + 6}};
  const auto stream = open(camera);
  DepthFrame frame;
  REQUIRE(stream->next(frame));
  CHECK_THROWS_WITH_AS(stream->next(frame), "/dev/video9: frame 1 has 13 of its 14 bytes", Error);
  CHECK_THROWS_AS(stream->next(frame), Error);
  CHECK_THROWS_WITH_AS(stream->next(frame), "/dev/video9: frame 3 has the time 1 s, which is not after 1 s", Error);
  REQUIRE(stream->next(frame));
  CHECK(frame.time_s == 3);
  CHECK(camera.isQueued == std::vector<bool>{true, true});
}

TEST_CASE("an unplugged depth camera ends the stream with an error") {
  for (const auto& [error, sentence] : {std::pair{ENODEV, "/dev/video9: is disconnected; plug the camera in again"},
                                        std::pair{EIO, "/dev/video9: delivers no more frames: Input/output error"}}) {
    FakeCamera camera;
    camera.shots = {{.time_s = 1}, {.error = error}, {.time_s = 2}};
    const auto stream = open(camera);
    DepthFrame frame;
    REQUIRE(stream->next(frame));
    CHECK_THROWS_WITH_AS(stream->next(frame), sentence, Error);
    CHECK_FALSE(stream->next(frame));
  }
}

TEST_CASE("stop ends a wait for a camera that sends no frames") {
  FakeCamera camera;
  const auto stream = open(camera);
  auto read = std::async(std::launch::async, [&] {
    DepthFrame frame;
    return stream->next(frame);
  });
  CHECK(read.wait_for(std::chrono::milliseconds(20)) == std::future_status::timeout);
  stream->stop();
  CHECK_FALSE(read.get());
  CHECK_THROWS_AS(stream->rewind(), Error);
}

TEST_CASE("opening a file that is not a video device is refused") {
  const ScratchFolder folder;
  CHECK_THROWS_WITH_AS(openDepthCamera((folder / "none").string(), {.camera = kCamera}),
                       doctest::Contains("cannot be opened: No such file"), Error);
  CHECK_THROWS_WITH_AS(openDepthCamera("/dev/null", {.camera = kCamera}), "/dev/null: is not a video device", Error);
}

}  // namespace palpate::depth_camera_test
