// Folders of depth images: frames show the scene before the camera, and errors give file and line.
#include "engine/io/rgbd_folder.hpp"

#include <doctest/doctest.h>

#include <functional>

#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/content_of.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/near.hpp"
#include "tests/rgbd_writer.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/shared_files.hpp"

namespace palpate::rgbd_folder_test {

namespace {

using test::checkSaid;
using Write = void (*)(const std::filesystem::path&, const RecordingPlan&);

void replaceIn(const std::filesystem::path& file, const std::string& what, const std::string& by) {
  std::string text = contentOf(file);
  const std::size_t at = text.find(what);
  REQUIRE(at != text.npos);
  writeBytes(file, text.replace(at, what.size(), by));
}

/// All results of next(): frames, and the messages of dropped ones.
struct Played {
  std::vector<DepthFrame> frames;
  std::vector<std::string> lost;
};
Played play(DepthStream& stream) {
  Played played;
  for (int guard = 0; guard < 1000; ++guard) {
    DepthFrame frame;
    try {
      if (!stream.next(frame)) return played;
      played.frames.push_back(frame);
    } catch (const Error& error) {
      played.lost.emplace_back(error.what());
    }
  }
  FAIL("the stream does not end");
  return played;
}

Played playAfter(Write write, const std::function<void(const std::filesystem::path&)>& harm) {
  const ScratchFolder folder;
  write(folder.path(), {});
  harm(folder.path());
  RgbdFolder stream(folder.path());
  return play(stream);
}

std::string refusalAfter(Write write, const std::function<void(const std::filesystem::path&)>& harm) {
  const ScratchFolder folder;
  write(folder.path(), {});
  harm(folder.path());
  try {
    RgbdFolder stream(folder.path());
  } catch (const FileError& error) {
    const std::string text = error.what(), place = folder.path().string() + "/";
    return text.starts_with(place) ? text.substr(place.size()) : text;
  }
  return "opened";
}

class Remarks final : public LogListener {
 public:
  Remarks() { log.listen(this); }
  void said(std::string_view line) override { lines.emplace_back(line); }
  void progressed(std::string_view, double) override {}
  Log log{true};
  std::vector<std::string> lines;
};

}  // namespace

TEST_CASE("frames of both kinds of RGB-D folder show the scene, with its poses and colours") {
  for (const auto& [write, scale, late_s] :
       {std::tuple{&writeRedwood, 1000.0, 1e-12}, std::tuple{&writeTum, 5000.0, 1e-6}}) {
    const ScratchFolder folder;
    const RecordingPlan plan{.frames = 5, .rate_Hz = 30};
    write(folder.path(), plan);
    REQUIRE(isRgbdFolder(folder.path()));
    RgbdFolder stream(folder.path());
    CAPTURE(stream.kind());
    CHECK(stream.camera() == recordedCamera());
    CHECK(stream.isRecorded());
    CHECK(stream.frames() == 5);
    CHECK(stream.duration_s() == near(4.0 / 30, 1e-5));
    CHECK(stream.depthScale() == scale);
    CHECK(stream.poses() == 5);
    CHECK(stream.colors() == 5);
    const Played played = play(stream);
    CHECK(played.lost.empty());
    REQUIRE(played.frames.size() == 5);
    for (std::size_t i = 0; i < played.frames.size(); ++i) {
      const DepthFrame& frame = played.frames[i];
      const double time_s = static_cast<double>(i) / plan.rate_Hz;
      CHECK(frame.number == i);
      CHECK(std::abs(frame.time_s - time_s) < late_s);
      REQUIRE(frame.pose.has_value());
      const CameraPose truth = recordedPose(time_s);
      CHECK(glm::distance(frame.pose->centre, truth.centre) < 1e-6);
      CHECK(angleBetween_deg(frame.pose->turn * DVec3(0, 0, 1), truth.turn * DVec3(0, 0, 1)) < 1e-4);
      const std::vector<float> depth_m = depthSeen(recordedCamera(), truth);
      REQUIRE(frame.depth_m.size() == depth_m.size());
      double farthest = 0;
      std::size_t seen = 0;
      for (std::size_t pixel = 0; pixel < depth_m.size(); ++pixel) {
        farthest = std::max(farthest, std::abs(double{frame.depth_m[pixel]} - double{depth_m[pixel]}));
        seen += frame.depth_m[pixel] > 0;
      }
      CHECK(farthest <= 0.51 / scale);
      CHECK(seen > 40);
      CHECK(seen < depth_m.size());
      CHECK(frame.colors.at(24 * 3 + 5) == std::array<std::uint8_t, 3>{5, 3, static_cast<std::uint8_t>(i)});
    }
  }
}

TEST_CASE("an RGB-D folder is replayed from its first frame, and skips frames up to a time") {
  const ScratchFolder folder;
  writeRedwood(folder.path(), {.frames = 6});
  RgbdFolder stream(folder.path());
  const Played first = play(stream);
  stream.rewind();
  const Played again = play(stream);
  REQUIRE(again.frames.size() == first.frames.size());
  for (std::size_t i = 0; i < first.frames.size(); ++i) CHECK(again.frames[i].depth_m == first.frames[i].depth_m);
  stream.rewind();
  CHECK(stream.skipTo(0) == 0);
  CHECK(stream.skipTo(3.4 / 30) == 3);
  DepthFrame frame;
  REQUIRE(stream.next(frame));
  CHECK(frame.number == 3);
  CHECK(stream.skipTo(1e9) == 1);
  REQUIRE(stream.next(frame));
  CHECK(frame.number == 5);
  CHECK_FALSE(stream.next(frame));
  CHECK(stream.skipTo(1e9) == 0);
}

TEST_CASE("numbers in Redwood's file names are times, and missing numbers are gaps") {
  const ScratchFolder folder;
  writeRedwood(folder.path(), {.frames = 3});
  std::string log = contentOf(folder / "trajectory.log");
  for (const int i : {2, 1}) {
    std::filesystem::rename(folder / fmt::format("depth/{:05}.png", i), folder / fmt::format("depth/{:05}.png", 5 * i));
    std::filesystem::rename(folder / fmt::format("color/{:05}.png", i),
                            folder / fmt::format("color/frame-{:06}.rgb.png", 5 * i));
    const std::string head = fmt::format("{} {} {}\n", i, i, i + 1);
    log.replace(log.find(head), head.size(), fmt::format("{0} {0} {1}\n", 5 * i, 5 * i + 1));
  }
  writeBytes(folder / "trajectory.log", log);
  RgbdFolder stream(folder.path());
  const Played played = play(stream);
  CHECK(played.lost.empty());
  REQUIRE(played.frames.size() == 3);
  CHECK(played.frames[1].time_s == near(5.0 / 30, 1e-6));
  CHECK(played.frames[2].time_s == near(10.0 / 30, 1e-6));
  CHECK(played.frames[2].colors.front()[2] == 2);
}

TEST_CASE("Redwood poses numbered from 1 belong to the images in order") {
  const Played played = playAfter(&writeRedwood, [](const auto& folder) {
    std::string log = contentOf(folder / "trajectory.log");
    for (const int i : {3, 2, 1, 0}) {
      const std::string head = fmt::format("{} {} {}\n", i, i, i + 1);
      log.replace(log.find(head), head.size(), fmt::format("{0} {0} {1}\n", i + 1, i + 2));
    }
    writeBytes(folder / "trajectory.log", log);
  });
  REQUIRE(played.frames.size() == 4);
  CHECK(glm::distance(played.frames[3].pose->centre, recordedPose(0.1).centre) < 1e-6);
}

TEST_CASE("RGB-D frames have no poses without a trajectory, and no colours without colour images") {
  for (const Write write : {&writeRedwood, &writeTum}) {
    const Played played = playAfter(write, [](const auto& folder) {
      for (const char* name : {"trajectory.log", "groundtruth.txt", "rgb.txt", "color"})
        std::filesystem::remove_all(folder / name);
    });
    REQUIRE(played.frames.size() == 4);
    CHECK_FALSE(played.frames[2].pose.has_value());
    CHECK(played.frames[2].colors.empty());
    CHECK(played.lost.empty());
  }
}

TEST_CASE("default intrinsics are reported, and given ones override those of the folder") {
  const ScratchFolder folder;
  writeRedwood(folder.path());
  writeBytes(folder / "other.json", intrinsicsJson({.width = 24, .height = 18, .fx = 30, .fy = 30, .cx = 1, .cy = 2},
                                                   R"(, "depth_scale": 500, "fps": 10)"));
  RgbdFolder given(folder.path(), {.intrinsics = folder / "other.json"});
  CHECK(given.camera().fx == 30);
  CHECK(given.depthScale() == 500);
  CHECK(given.duration_s() == near(0.3, 1e-6));
  CHECK(RgbdFolder(folder.path(), {.intrinsics = folder / "other.json", .depthScale = 200}).depthScale() == 200);

  std::filesystem::remove(folder / "intrinsics.json");
  Remarks remarks;
  CHECK_THROWS_WITH_AS(
      RgbdFolder(folder.path(), {}, &remarks.log),
      doctest::Contains("00000.png: has 24 x 18 pixels, and the camera 640 x 480; give the intrinsics"), FileError);
  REQUIRE(remarks.lines.size() == 1);
  CHECK(says(remarks.lines[0],
             "has no intrinsics; assuming 640 x 480 pixels, focal lengths 525 and 525, principal point 319.5, 239.5"));
}

TEST_CASE("colour images of another size are resized, and that is reported once") {
  const ScratchFolder folder;
  writeTum(folder.path());
  for (const auto& entry : std::filesystem::directory_iterator(folder / "rgb"))
    writeBytes(entry.path(), colorPng(48, 36, 9));
  Remarks remarks;
  RgbdFolder stream(folder.path(), {}, &remarks.log);
  const Played played = play(stream);
  REQUIRE(played.frames.size() == 4);
  CHECK(played.frames[0].colors.at(24 * 2 + 7) == std::array<std::uint8_t, 3>{15, 5, 9});
  REQUIRE(remarks.lines.size() == 1);
  CHECK(says(remarks.lines[0], "has 48 x 36 pixels; colours are resampled to the 24 x 18 of depth"));
}

TEST_CASE("an RGB-D frame that cannot be read is dropped with its file name, and later ones are read") {
  using Path = std::filesystem::path;
  const auto loses = [](Write write, const char* lost, const std::function<void(const Path&)>& harm) {
    const Played played = playAfter(write, harm);
    REQUIRE(played.lost.size() == 1);
    REQUIRE(played.frames.size() == 3);
    CHECK(played.frames[1].number == 2);  // the number of the dropped frame is not reused
    checkSaid(played.lost[0], lost);
  };
  const auto second = [](const Path& folder) { return folder / "depth" / "00001.png"; };
  loses(&writeRedwood, "...00001.png: has 2 x 2 pixels, and the camera 24 x 18...",
        [&](const Path& f) { writeBytes(second(f), greyPng(2, 2, std::vector<std::uint16_t>(4, 9))); });
  loses(&writeRedwood, "...00001.png: is not a grey PNG of 16 bits...",
        [&](const Path& f) { writeBytes(second(f), pngBytes(24, 18, 8, 0, std::string(24 * 18, 'x'))); });
  loses(&writeRedwood, "...00001.png: has no depth at all...",
        [&](const Path& f) { writeBytes(second(f), greyPng(24, 18, std::vector<std::uint16_t>(24 * 18))); });
  loses(&writeRedwood, "...ends within the picture...",
        [&](const Path& f) { std::filesystem::resize_file(second(f), 300); });
  loses(&writeRedwood, "...trajectory.log:6: frame 1 has a pose but no picture of depth...",
        [&](const Path& f) { std::filesystem::remove(second(f)); });
  loses(&writeRedwood, "...00001.png: has no colour picture of the same number...",
        [](const Path& f) { std::filesystem::remove(f / "color" / "00001.png"); });
  loses(&writeTum, "...depth.txt:3: 1305031102.208637.png has no colours within 0.02 s...",
        [](const Path& f) { replaceIn(f / "rgb.txt", "1305031102.219637", "1305031102.239637"); });
  loses(&writeTum, "...1305031102.208637.png: cannot be read...",
        [](const Path& f) { std::filesystem::remove(f / "depth" / "1305031102.208637.png"); });
}

TEST_CASE("RGB-D frames without a pose are dropped if others have one, at the start or at the end") {
  const Played shorter = playAfter(&writeRedwood, [](const auto& folder) {
    const std::string log = contentOf(folder / "trajectory.log");
    writeBytes(folder / "trajectory.log", log.substr(0, log.find("2 2 3\n")));
  });
  CHECK(shorter.frames.size() == 2);
  REQUIRE(shorter.lost.size() == 2);
  CHECK(says(shorter.lost[0], "00002.png: has no pose in trajectory.log"));
  const Played early = playAfter(&writeTum, [](const auto& folder) {
    const std::string poses = contentOf(folder / "groundtruth.txt");
    writeBytes(folder / "groundtruth.txt", "# late\n" + poses.substr(poses.find("1305031102.24")));
  });
  CHECK(early.frames.size() == 1);
  REQUIRE(early.lost.size() == 3);
  CHECK(says(early.lost[0], "depth.txt:2: 1305031102.175304.png has no poses in groundtruth.txt"));
}

TEST_CASE("a colour image belongs to the nearest depth image, and to one only") {
  const ScratchFolder folder;
  writeTum(folder.path(), {.frames = 2, .rate_Hz = 100});
  // The first depth image is 4 ms from the only colour image, the second one 6 ms.
  const std::string name = "1305031102.175304.png";
  writeBytes(folder / "rgb.txt", "1305031102.179304 rgb/" + name + "\n");
  RgbdFolder stream(folder.path());
  const Played played = play(stream);
  REQUIRE(played.frames.size() == 1);
  CHECK(played.frames[0].number == 0);
  CHECK(played.lost.size() == 1);
}

TEST_CASE("invalid lists of an RGB-D folder are refused on opening, with file and line") {
  // A list of a folder in which `what` is replaced, or all of it if that is empty.
  const auto listIs = [](Write write) {
    return [write](const char* list, const std::string& what, const std::string& by, const std::string& expected) {
      const auto harm = [&](const std::filesystem::path& folder) {
        if (what.empty())
          writeBytes(folder / list, by);
        else
          replaceIn(folder / list, what, by);
      };
      checkSaid(refusalAfter(write, harm), expected);
    };
  };
  const auto redwood = listIs(&writeRedwood), tum = listIs(&writeTum);
  CHECK(refusalAfter(&writeRedwood, [](const auto&) {}) == "opened");
  CHECK(refusalAfter(&writeTum, [](const auto&) {}) == "opened");
  const std::string second = "1305031102.208637 ";
  tum("depth.txt", "", "# nothing\n\n", "...depth.txt: lists no pictures...");
  tum("depth.txt", second, "noon ",
      "...depth.txt:3: found 'noon', expected a time in seconds and the name of a picture...");
  tum("depth.txt", second, "nan ", "...depth.txt:3: found...");
  tum("depth.txt", second, "1305031102.175304 ", "...depth.txt:3: time 1305031102.175304 s is a duplicate of line...");
  tum("rgb.txt", "1305031102.219637 ", "7 ", "opened");  // lists that are not in order of time are sorted
  tum("rgb.txt", "", "# color\n", "opened");             // an empty list is treated as missing
  tum("groundtruth.txt", "1305031102.172304 ", "1305031102.172304 7 ",
      "...groundtruth.txt:3: expected eight numbers...");
  tum("groundtruth.txt", "", "1 0 0 0 0 0 0 2\n",
      "...groundtruth.txt:1: the quaternion of the pose has the length 2...");
  tum("groundtruth.txt", "", "1 0 0 nan 0 0 0 1\n", "...groundtruth.txt:1: the position of the pose...");
  redwood("trajectory.log", "1 1 2", "one", "...trajectory.log:6: found 'one'...");
  redwood("trajectory.log", "1 1 2", "0 0 1", "...trajectory.log:6: frame 0 is a duplicate of line 1...");
  redwood("trajectory.log", "1 1 2", "1e18 1 2", "...trajectory.log:6: found...");
  redwood("trajectory.log", "", "0 0 1\n1 0 0 0\n0 1 0 0\n",
          "...trajectory.log:3: ends within the pose that begins in line 1...");
  redwood("trajectory.log", "", "0 0 1\n1 0 0 0\n0 1 0\n",
          "...trajectory.log:3: found '0 1 0', expected the four numbers of a row...");
  redwood("trajectory.log", "", "0 0 1\n1 0 0 0\n0 3 0 0\n0 0 1 0\n0 0 0 1\n",
          "...trajectory.log:1: the first three columns of the pose are not a rotation...");
  redwood("trajectory.log", "", "", "opened");
  redwood("intrinsics.json", "", "{}", "...intrinsics.json: has no \"width\"...");
  const auto depth = [](const auto& harm, const char* expected) {
    checkSaid(refusalAfter(&writeRedwood, [&](const auto& folder) { harm(folder / "depth"); }), expected);
  };
  depth([](const auto& d) { std::filesystem::copy(d / "00001.png", d / "1.png"); }, "...has the same number as...");
  depth([](const auto& d) { std::filesystem::copy(d / "00001.png", d / "last.png"); }, "...has no number...");
  depth(
      [](const auto& d) {
        std::filesystem::remove_all(d);
        std::filesystem::create_directory(d);
      },
      "...depth: has no pictures...");
  const ScratchFolder empty;
  CHECK_FALSE(isRgbdFolder(empty.path()));
  CHECK_FALSE(isRgbdFolder(empty / "none"));
  CHECK_THROWS_WITH_AS(RgbdFolder(empty.path()),
                       doctest::Contains("is not a folder of TUM (depth.txt or depth/TIME.png), ScanNet"), FileError);
}

TEST_CASE("an RGB-D list cut off at any byte is read or refused") {
  for (const auto& [write, name] :
       {std::pair{&writeRedwood, "trajectory.log"}, std::pair{&writeTum, "depth.txt"},
        std::pair{&writeTum, "groundtruth.txt"}, std::pair{&writeRedwood, "intrinsics.json"}}) {
    CAPTURE(name);
    const ScratchFolder folder;
    write(folder.path(), {.frames = 2});
    const std::string whole = contentOf(folder / name);
    std::size_t opened = 0;
    for (std::size_t size = 0; size<whole.size(); size += whole.size()> 400 ? 7 : 1) {
      writeBytes(folder / name, whole.substr(0, size));
      try {
        RgbdFolder stream(folder.path());
        play(stream);
        ++opened;
      } catch (const FileError&) {
      }
    }
    CHECK(opened < whole.size());
  }
}

TEST_CASE("the up direction of an RGB-D folder follows from the orientation of the cameras") {
  const ScratchFolder folder;
  writeRedwood(folder.path());
  CHECK(RgbdFolder(folder.path()).up() == UpAxis::minusY);
  // The camera's right is the world's x, its down the world's -z.
  writeBytes(folder / "trajectory.log", "0 0 1\n1 0 0 0\n0 0 1 0\n0 -1 0 0\n0 0 0 1\n");
  CHECK(RgbdFolder(folder.path()).up() == UpAxis::z);
}

TEST_CASE("ROS and RealSense bags are recognized by their first bytes, and the error names a converter") {
  const ScratchFolder folder;
  for (const char* begin : {"#ROSBAG V2.0\n\x45", "\x89MCAP0\r\n", "SQLite format 3"}) {
    writeBytes(folder / "a.ply", begin);
    for (const auto& read :
         {std::function([&] { readCloud(folder / "a.ply"); }), std::function([&] { contentsOf(folder / "a.ply"); })})
      CHECK_THROWS_WITH_AS(
          read(), doctest::Contains("is a bag of ROS or of a RealSense camera, which is not read; Open3D can write"),
          FileError);
  }
}

TEST_CASE("a real RGB-D recording is read completely") {
  const std::filesystem::path folder = sharedFile("rgbd_livingroom_a");
  if (folder.empty()) return;
  RgbdFolder stream(folder);
  CHECK(stream.camera() == DepthCamera{.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5});
  CHECK(stream.depthScale() == 1000);
  CHECK(stream.kind() == "Redwood");
  CHECK(stream.duration_s() == near(3.2, 1e-6));
  CHECK(stream.up() == UpAxis::minusY);
  const Played played = play(stream);
  CHECK(played.lost.empty());
  REQUIRE(played.frames.size() == 25);
  double last_s = -1;
  for (const DepthFrame& frame : played.frames) {
    CHECK(frame.time_s > last_s);
    last_s = frame.time_s;
    REQUIRE(frame.depth_m.size() == 640 * 480);
    CHECK(frame.colors.size() == 640 * 480);
    REQUIRE(frame.pose.has_value());
    const auto [least, most] = std::ranges::minmax(frame.depth_m);
    CHECK(least >= 0);
    CHECK(most > 1);
    CHECK(most < 10);
  }
  CHECK(played.frames[0].pose->centre == DVec3(0));
  CHECK(glm::distance(played.frames[1].pose->centre, DVec3(0.00622254, -0.09654850, -0.00728249)) < 1e-9);
}

}  // namespace palpate::rgbd_folder_test
