// Raw frames from another program: frames are read as written, and a torn, late or invalid frame is dropped alone.
#include "engine/io/depth_pipe.hpp"

#include <doctest/doctest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/system_file.hpp"
#include "tests/near.hpp"
#include "tests/rgbd_writer.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::depth_pipe_test {

namespace {

constexpr DepthCamera kCamera{.width = 5, .height = 4, .fx = 6, .fy = 7, .cx = 2, .cy = 1.5};
constexpr std::size_t kPixels = 20;

std::string head(const std::string& more = R"(, "depth_scale": 1000, "format": "z16")") {
  return intrinsicsJson(kCamera, more) + "\n";
}

/// Depths increase by 100 from frame to frame, and by one from pixel to pixel.
std::string depths(int number) {
  std::string bytes;
  for (std::size_t i = 0; i < kPixels; ++i) {
    const std::size_t value = static_cast<std::size_t>(100 * number + 1000) + i;
    bytes += {static_cast<char>(value & 0xff), static_cast<char>(value >> 8)};
  }
  return bytes;
}
std::string frame(int number, double time_s) { return fmt::format("frame {}\n", time_s) + depths(number); }

std::string poseText(const CameraPose& pose) { return fmt::format("{}", fmt::join(rowsOf(pose), " ")); }

struct Heard {
  std::vector<DepthFrame> frames;
  std::vector<std::string> lost;
  std::vector<double> times_s() const {
    std::vector<double> times;
    for (const DepthFrame& frame : frames) times.push_back(frame.time_s);
    return times;
  }
};

/// Reads the bytes from a file, which never blocks.
Heard hear(const std::string& bytes, double depthScale = 0) {
  const ScratchFolder folder;
  writeBytes(folder / "frames", bytes);
  std::FILE* const file = openFile(folder / "frames", "rb");
  REQUIRE(file);
  Heard heard;
  try {
    DepthPipe pipe(::fileno(file), "input", depthScale);
    CHECK_FALSE(pipe.isRecorded());
    CHECK(pipe.camera() == kCamera);
    for (int guard = 0; guard < 1000; ++guard) {
      DepthFrame frame;
      try {
        if (!pipe.next(frame)) break;
        heard.frames.push_back(frame);
      } catch (const Error& error) {
        heard.lost.emplace_back(error.what());
      }
    }
  } catch (const Error& error) {
    heard.lost.emplace_back(error.what());
  }
  std::fclose(file);
  return heard;
}

bool isFrame(const DepthFrame& frame, int number) {
  if (frame.depth_m.size() != kPixels) return false;
  for (std::size_t i = 0; i < kPixels; ++i)
    if (std::abs(frame.depth_m[i] - 0.001f * static_cast<float>(100 * number + 1000 + static_cast<int>(i))) > 1e-6f)
      return false;
  return true;
}

}  // namespace

TEST_CASE("piped frames are read as written, with times since the first one, poses and colours") {
  const CameraPose pose = recordedPose(2);
  std::string bytes = head(R"(, "depth_scale": 1000, "format": "z16+rgb8")");
  for (int i = 0; i < 3; ++i) {
    bytes += fmt::format("frame {} {}\n", 100 + 0.1 * i, poseText(pose)) + depths(i);
    for (std::size_t k = 0; k < 3 * kPixels; ++k) bytes += static_cast<char>(k + static_cast<std::size_t>(i));
  }
  const Heard heard = hear(bytes);
  CHECK(heard.lost.empty());
  REQUIRE(heard.frames.size() == 3);
  for (int i = 0; i < 3; ++i) {
    const DepthFrame& each = heard.frames[static_cast<std::size_t>(i)];
    CHECK(isFrame(each, i));
    CHECK(each.number == static_cast<std::uint64_t>(i));
    CHECK(std::abs(each.time_s - 0.1 * i) < 1e-12);
    CHECK(each.colors.at(1) == std::array<std::uint8_t, 3>{static_cast<std::uint8_t>(3 + i),
                                                           static_cast<std::uint8_t>(4 + i),
                                                           static_cast<std::uint8_t>(5 + i)});
    REQUIRE(each.pose.has_value());
    CHECK(glm::distance(each.pose->toWorld({1, 2, 3}), pose.toWorld({1, 2, 3})) < 1e-9);
  }
}

TEST_CASE("the first line may give a pose for all frames, and a given scale overrides its own") {
  const CameraPose pose = recordedPose(1);
  const std::string more =
      fmt::format(R"(, "depth_scale": 1000, "format": "z16", "pose": [{}])", fmt::join(rowsOf(pose), ", "));
  const Heard heard = hear(head(more) + frame(0, 0) + frame(1, 0.5), 2000);
  REQUIRE(heard.frames.size() == 2);
  REQUIRE(heard.frames[1].pose.has_value());
  CHECK(glm::distance(heard.frames[1].pose->centre, pose.centre) < 1e-9);
  CHECK(heard.frames[0].depth_m[0] == near(0.5, 1e-6));
  CHECK_FALSE(hear(head() + frame(0, 0)).frames.at(0).pose.has_value());
  CHECK(hear(head(R"(, "format": "z16")") + frame(0, 0), 1000).frames.size() == 1);
}

TEST_CASE("a first line without a valid camera is refused with the reason") {
  const auto refusal = [](const std::string& bytes) {
    const Heard heard = hear(bytes);
    CHECK(heard.frames.empty());
    return heard.lost.empty() ? std::string("read") : heard.lost.front();
  };
  CHECK(refusal("") == "input: ends before the line of JSON that says what its frames are");
  CHECK(says(refusal("frame 0\n"), "input: its first line, 'frame 0', is not valid JSON"));
  CHECK(says(refusal("{}\n"), "has no \"width\""));
  CHECK(says(refusal(head("")), "\"format\" is ''; expected z16 or z16+rgb8"));
  CHECK(says(refusal(head(R"(, "format": "z32")")), "expected z16 or z16+rgb8"));
  CHECK(says(refusal(head(R"(, "format": "z16")")), "has no \"depth_scale\""));
  CHECK(says(refusal(R"({"width": 8193, "height": 1})"
                     "\n"),
             "expected a whole number of pixels from 1 to 8192"));
  CHECK(says(refusal(std::string(1 << 20, 'x')), "is too long to be one"));
  CHECK(says(refusal(std::string(1 << 16, ' ') + head()), "is too long to be one"));
}

TEST_CASE("a frame with a repeated or earlier time is dropped, and later ones are read") {
  const Heard heard =
      hear(head() + frame(0, 1) + frame(1, 1) + frame(2, 0.5) + frame(3, 1.5) + "frame nan\n" + frame(5, 2));
  CHECK(heard.times_s() == std::vector<double>{0, 0.5, 1});
  REQUIRE(heard.lost.size() == 3);
  CHECK(heard.lost[0] == "input: frame 1 has the time 1 s, which is not after 1 s");
  CHECK(heard.lost[1] == "input: frame 2 has the time 0.5 s, which is not after 1 s");
  CHECK(says(heard.lost[2], "input: frame 4 begins with 'frame nan'; expected a time"));
  CHECK(isFrame(heard.frames[1], 3));
  CHECK(heard.frames[1].number == 3);
}

TEST_CASE("a torn frame is dropped, and all frames read after it are complete") {
  const std::string torn = frame(1, 0.1);
  for (std::size_t size = 1; size < torn.size(); ++size) {
    CAPTURE(size);
    const Heard heard = hear(head() + frame(0, 0) + torn.substr(0, size) + frame(2, 0.2) + frame(3, 0.3));
    REQUIRE(heard.frames.size() >= 2);
    CHECK(isFrame(heard.frames.front(), 0));
    CHECK(isFrame(heard.frames.back(), 3));
    // Bytes of the next line can be taken for the last pixels if fewer than six bytes are missing.
    const bool isPassable = torn.size() - size < 6;
    if (isPassable) continue;
    for (std::size_t i = 1; i < heard.frames.size(); ++i)
      CHECK(isFrame(heard.frames[i], static_cast<int>(std::lround(10 * heard.frames[i].time_s))));
    CHECK(heard.lost.size() >= 1);
  }
}

TEST_CASE("bytes between frames are skipped, and reported as a dropped frame") {
  const Heard heard = hear(head() + frame(0, 0) + std::string(100'000, 'f') + "frame frame" + frame(1, 0.1));
  CHECK(heard.frames.size() == 2);
  CHECK(heard.lost.size() >= 1);
  CHECK(says(heard.lost.at(0), "instead of 'frame'; the input up to the next frame is skipped"));
  CHECK(isFrame(heard.frames.back(), 1));
  CHECK(hear(head() + frame(0, 0) + "\n" + frame(1, 0.1) + "\n").lost.empty());
  CHECK(hear(head() + "frame 0" + std::string(5000, ' ') + "\n" + depths(0) + frame(1, 0.1)).frames.size() == 1);
}

TEST_CASE("a stream that ends within a frame keeps the earlier ones, and reports the end once") {
  const std::string whole = head() + frame(0, 0) + frame(1, 0.1);
  const std::size_t second = (head() + frame(0, 0)).size();
  for (std::size_t size = head().size(); size < whole.size(); ++size) {
    CAPTURE(size);
    const Heard heard = hear(whole.substr(0, size));
    CHECK(heard.frames.size() == (size >= second ? 1 : 0));
    const bool endsBetween = size == second || size == head().size();
    CHECK(heard.lost.size() == (endsBetween ? 0 : 1));
    if (size >= second) CHECK(isFrame(heard.frames.front(), 0));
  }
  CHECK(
      says(hear(whole.substr(0, whole.size() - 3)).lost.at(0), "input: frame 1 has 37 of its 40 bytes; there it ends"));
}

TEST_CASE("frames with an invalid pose are dropped, and so are those without one if the first had one") {
  CameraPose pose = recordedPose(0);
  std::string bytes = head() + fmt::format("frame 0 {}\n", poseText(pose)) + depths(0);
  bytes += fmt::format("frame 1 {}\n", poseText(pose)).replace(8, 1, "9") + depths(1);
  bytes += frame(2, 2) + fmt::format("frame 3 {}\n", poseText(pose)) + depths(3);
  const Heard heard = hear(bytes);
  CHECK(heard.times_s() == std::vector<double>{0, 3});
  REQUIRE(heard.lost.size() >= 2);
  CHECK(says(heard.lost.front(), "not a rotation"));
  CHECK(says(heard.lost.back(), "has no pose, and the first one had one"));
}

TEST_CASE("memory is allocated for received bytes, not for the size in the first line") {
  const std::string large =
      R"({"width": 8192, "height": 8192, "fx": 5, "fy": 5, "cx": 0, "cy": 0, "depth_scale": 1, "format": "z16+rgb8"})";
  const ScratchFolder folder;
  writeBytes(folder / "frames", large + "\nframe 0\nxyz");
  std::FILE* const file = openFile(folder / "frames", "rb");
  REQUIRE(file);
  DepthPipe pipe(::fileno(file), "input");
  DepthFrame frame;
  CHECK_THROWS_WITH_AS(pipe.next(frame), "input: frame 0 has 3 of its 335544320 bytes; there it ends", Error);
  CHECK(frame.depth_m.capacity() == 0);
  CHECK_FALSE(pipe.next(frame));
  CHECK_THROWS_AS(pipe.rewind(), Error);
  std::fclose(file);
}

}  // namespace palpate::depth_pipe_test
