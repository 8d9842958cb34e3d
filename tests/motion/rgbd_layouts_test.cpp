// Each layout of a folder of depth frames gives the same map, on the recorded surface.
#include <doctest/doctest.h>
#include <fmt/ranges.h>

#include "engine/core/error.hpp"
#include "engine/io/rgbd_folder.hpp"
#include "engine/motion/frame_fusion.hpp"
#include "tests/content_of.hpp"
#include "tests/near.hpp"
#include "tests/rgbd_writer.hpp"
#include "tests/says.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::rgbd_layouts_test {

namespace {

using Path = std::filesystem::path;
constexpr int kFrames = 6;
constexpr double kRate_Hz = 30;

void writeFile(const Path& file, const std::string& bytes) {
  std::filesystem::create_directories(file.parent_path());
  writeBytes(file, bytes);
}

/// Numbers in lines of `perLine`.
std::string linesOf(std::span<const double> numbers, std::size_t perLine) {
  std::string text;
  for (std::size_t k = 0; k < numbers.size(); ++k)
    text += fmt::format("{:.9f}{}", numbers[k], (k + 1) % perLine == 0 ? '\n' : ' ');
  return text;
}

std::string poseRows(int frame, std::size_t perLine) {
  return linesOf(rowsOf(recordedPose(frame / kRate_Hz)), perLine);
}

std::string matrixOfCamera(std::size_t size) {
  const DepthCamera camera = recordedCamera();
  std::vector<double> matrix(size * size);
  for (std::size_t k = 0; k < size; ++k) matrix[k * size + k] = 1;
  matrix[0] = camera.fx, matrix[2] = camera.cx, matrix[size + 1] = camera.fy, matrix[size + 2] = camera.cy;
  return linesOf(matrix, size);
}

std::string depthAt(int frame, double scale, std::uint16_t none = 0) {
  std::vector<std::uint16_t> values;
  for (const float depth : depthSeen(recordedCamera(), recordedPose(frame / kRate_Hz)))
    values.push_back(depth > 0 ? static_cast<std::uint16_t>(std::lround(depth * scale)) : none);
  return greyPng(recordedCamera().width, recordedCamera().height, values);
}
std::string colorAt(int frame) { return colorPng(recordedCamera().width, recordedCamera().height, frame); }

void writeScanNet(const Path& folder) {
  for (int i = 0; i < kFrames; ++i) {
    writeFile(folder / fmt::format("depth/{}.png", i), depthAt(i, 1000));
    writeFile(folder / fmt::format("color/{}.png", i), colorAt(i));
    writeFile(folder / fmt::format("pose/{}.txt", i), poseRows(i, 4));
  }
  writeFile(folder / "intrinsic/intrinsic_depth.txt", matrixOfCamera(4));
  writeFile(folder / "intrinsic/intrinsic_color.txt", "1170 0 647 0\n0 1170 483 0\n0 0 1 0\n0 0 0 1\n");
}

void writeSevenScenes(const Path& folder) {
  for (int i = 0; i < kFrames; ++i) {
    const std::string name = fmt::format("frame-{:06}", i);
    writeFile(folder / (name + ".depth.png"), depthAt(i, 1000, 65535));
    writeFile(folder / (name + ".color.png"), colorAt(i));
    writeFile(folder / (name + ".pose.txt"), poseRows(i, 4));
  }
  writeFile(folder / "camera-intrinsics.txt", matrixOfCamera(3));
}

void writeReplica(const Path& folder) {
  std::string poses;
  for (int i = 0; i < kFrames; ++i) {
    writeFile(folder / fmt::format("results/depth{:06}.png", i), depthAt(i, 6553.5));
    writeFile(folder / fmt::format("results/frame{:06}.png", i), colorAt(i));
    poses += poseRows(i, 16);
  }
  const DepthCamera camera = recordedCamera();
  writeFile(folder / "traj.txt", poses);
  writeFile(
      folder / "cam_params.json",
      fmt::format(R"({{"camera": {{"w": {}, "h": {}, "fx": {}, "fy": {}, "cx": {}, "cy": {}, "scale": 6553.5}}}})",
                  camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy));
}

/// A TUM folder without its lists of pictures, whose poses are recorded at other times.
void writeTimes(const Path& folder) {
  writeTum(folder, {.frames = kFrames, .rate_Hz = kRate_Hz});
  for (const char* list : {"depth.txt", "rgb.txt"}) std::filesystem::remove(folder / list);
  writeFile(folder / "intrinsics.txt", fmt::format("{} {} {} {}\n", 20, 21, 11.5, 8.5));
  std::filesystem::remove(folder / "intrinsics.json");
}

/// Names in nanoseconds, poses of 12 numbers a line in the same order.
void writeNanoseconds(const Path& folder) {
  std::string poses;
  for (int i = 0; i < kFrames; ++i) {
    const std::string name = fmt::format("{}.png", 1'403'636'579'763'555'584 + std::llround(i / kRate_Hz * 1e9));
    writeFile(folder / "depth" / name, depthAt(i, 1000));
    writeFile(folder / "image" / name, colorAt(i));
    const auto rows = rowsOf(recordedPose(i / kRate_Hz));
    poses += linesOf(std::span(rows).first(12), 12);
  }
  writeFile(folder / "poses.txt", poses);
  writeFile(folder / "intrinsics.json", intrinsicsJson(recordedCamera()));
}

struct Layout {
  std::string kind;
  void (*write)(const Path&);
  double scale;
};
const Layout kLayouts[]{
    {"TUM", [](const Path& folder) { writeTum(folder, {.frames = kFrames, .rate_Hz = kRate_Hz}); }, 5000},
    {"TUM", writeTimes, 5000},
    {"ScanNet", writeScanNet, 1000},
    {"Redwood", [](const Path& folder) { writeRedwood(folder, {.frames = kFrames, .rate_Hz = kRate_Hz}); }, 1000},
    {"Redwood", writeNanoseconds, 1000},
    {"Replica", writeReplica, 6553.5},
    {"7-Scenes", writeSevenScenes, 1000}};

std::vector<std::string> lostIn(RgbdFolder& stream) {
  std::vector<std::string> lost;
  DepthFrame frame;
  for (bool more = true; more;) {
    try {
      more = stream.next(frame);
    } catch (const Error& error) {
      lost.emplace_back(error.what());
    }
  }
  return lost;
}

std::string refusal(const Path& folder) {
  try {
    RgbdFolder stream(folder);
    return "opened";
  } catch (const FileError& error) {
    return error.what();
  }
}

}  // namespace

TEST_CASE("each layout of an RGB-D folder gives a coloured map on the recorded surface") {
  for (const Layout& layout : kLayouts) {
    const ScratchFolder folder;
    layout.write(folder.path());
    REQUIRE(isRgbdFolder(folder.path()));
    RgbdFolder stream(folder.path());
    CAPTURE(layout.kind);
    CHECK(stream.kind() == layout.kind);
    CHECK(stream.depthScale() == layout.scale);
    CHECK(stream.camera() == recordedCamera());
    CHECK(stream.frames() == kFrames);
    CHECK(stream.duration_s() == near((kFrames - 1) / kRate_Hz, 1e-4));
    CHECK(stream.poses() == kFrames);
    CHECK(stream.colors() == kFrames);
    FrameFusion fusion{FusionOptions{}};
    DepthFrame frame;
    while (stream.next(frame)) {
      const CameraPose truth = recordedPose(static_cast<double>(frame.number) / kRate_Hz);
      REQUIRE(frame.pose.has_value());
      CHECK(glm::distance(frame.pose->centre, truth.centre) < 1e-6);
      CHECK(frame.colors.front()[2] == frame.number);
      CHECK(std::ranges::max(frame.depth_m) < 3);
      CHECK(fusion.fuse(stream.camera(), frame).fate == FrameFate::fused);
    }
    CHECK(fusion.fused() == kFrames);
    const PointCloud map = fusion.map().cloud();
    REQUIRE(map.size() > 30);
    CHECK(map.hasColors());
    for (std::size_t i = 0; i < map.size(); ++i)
      CHECK(std::abs(recordedShape().signedDistance(map.fileCoordinates(i))) < 0.02);
  }
}

TEST_CASE("an RGB-D frame whose pose file is missing or not a pose is lost with its reason") {
  const ScratchFolder folder;
  writeScanNet(folder.path());
  writeFile(folder / "pose/1.txt", "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n0 0 0 1\n");
  writeFile(folder / "pose/3.txt", "1 0 0\n");
  std::filesystem::remove(folder / "pose/4.txt");
  RgbdFolder stream(folder.path());
  const std::vector<std::string> lost = lostIn(stream);
  REQUIRE(lost.size() == 3);
  CHECK(says(lost[0], "pose/1.txt:1: "));
  CHECK(says(lost[0], "finite"));
  CHECK(says(lost[1], "pose/3.txt:1: expected the four rows of a pose"));
  CHECK(says(lost[2], "depth/4.png: has no pose in pose"));
}

TEST_CASE("some depth pictures of a sequence have the poses of their numbers") {
  const ScratchFolder folder;
  writeReplica(folder.path());
  for (const int i : {0, 1, 3, 5}) {
    std::filesystem::remove(folder / fmt::format("results/depth{:06}.png", i));
    std::filesystem::remove(folder / fmt::format("results/frame{:06}.png", i));
  }
  RgbdFolder stream(folder.path());
  CHECK(stream.frames() == 2);
  DepthFrame frame;
  for (const int i : {2, 4}) {
    REQUIRE(stream.next(frame));
    CHECK(glm::distance(frame.pose->centre, recordedPose(i / kRate_Hz).centre) < 1e-6);
  }
}

TEST_CASE("the intrinsics of an RGB-D folder may lie beside it, and those of another camera are refused") {
  const ScratchFolder folder;
  const Path room = folder / "room0";
  writeReplica(room);
  std::filesystem::rename(room / "cam_params.json", folder / "cam_params.json");
  CHECK(RgbdFolder(room).camera() == recordedCamera());

  const Path scan = folder / "scan";
  writeScanNet(scan);
  writeFile(scan / "intrinsic/intrinsic_depth.txt", contentOf(scan / "intrinsic/intrinsic_color.txt"));
  CHECK(says(refusal(scan), "the principal point 647, 483 lies beside the pictures of 24 x 18 pixels"));
  for (const auto& [text, why] : {std::pair{"20 0 11\n0 21 8\n", "has 6 numbers"},
                                  {"20 0 11\n0 21 8\n0 1 1\n", "does not begin with 0 0 1"},
                                  {"20 1 11\n0 21 8\n0 0 1\n", "skew"},
                                  {"0 0 11\n0 21 8\n0 0 1\n", "focal lengths"},
                                  {"none\n", "is not valid JSON"}}) {
    writeFile(scan / "intrinsic/intrinsic_depth.txt", text);
    CHECK_MESSAGE(says(refusal(scan), why), refusal(scan));
  }
}

TEST_CASE("an RGB-D folder without intrinsics has the camera and the depth scale of its data set") {
  for (const auto& [write, focal, width, height, scale] : {std::tuple{&writeSevenScenes, 585.0, 640u, 480u, 1000.0},
                                                           std::tuple{&writeReplica, 600.0, 1200u, 680u, 6553.5}}) {
    const ScratchFolder folder;
    write(folder.path());
    for (const char* name : {"camera-intrinsics.txt", "cam_params.json"}) std::filesystem::remove(folder / name);
    const std::string blank = greyPng(width, height, std::vector<std::uint16_t>(std::size_t{width} * height, 2000));
    for (const char* first : {"frame-000000.depth.png", "results/depth000000.png"})
      if (std::filesystem::exists(folder / first)) writeFile(folder / first, blank);
    CHECK(RgbdFolder(folder.path()).camera().fx == focal);
    CHECK(RgbdFolder(folder.path()).depthScale() == scale);
  }
}

TEST_CASE("one of several files of poses is used, and the others are named") {
  const ScratchFolder folder;
  writeReplica(folder.path());
  writeFile(folder / "trajectory.log", "0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  class Remarks final : public LogListener {
   public:
    void said(std::string_view line) override { text += line; }
    void progressed(std::string_view, double) override {}
    std::string text;
  } remarks;
  Log log{true};
  log.listen(&remarks);
  RgbdFolder stream(folder.path(), {}, &log);
  CHECK(says(remarks.text, "poses are those of trajectory.log; not read: traj.txt"));
  CHECK(stream.poses() == 1);
}

TEST_CASE("pictures named by times and by numbers are not mixed") {
  const ScratchFolder folder;
  writeTimes(folder.path());
  writeFile(folder / "depth/7.png", depthAt(0, 5000));
  CHECK(says(refusal(folder.path()), "depth: 6 of its 7 files are named by a time, the others by a number"));
}

}  // namespace palpate::rgbd_layouts_test
