// A PLY file with the views of its points beside it: its normals face the images that saw them, and invalid views are
// refused with their byte.
#include "engine/io/known_formats.hpp"

#include <doctest/doctest.h>

#include <cstring>

#include "engine/cloud/up.hpp"
#include "engine/core/error.hpp"
#include "engine/io/cloud_formats.hpp"
#include "engine/io/saving.hpp"
#include "tests/colmap_writer.hpp"
#include "tests/io/file_cases.hpp"

namespace palpate::test::colmap_dense_test {
namespace {

constexpr int kSide = 12;                       // points along an edge of a sheet, and
constexpr std::size_t kSheet = kSide * kSide;   // of each of two sheets, both at z = 5
constexpr std::uint32_t kFront = 0, kBack = 2;  // indices of the images before and behind them; the ids differ

/// Images before, far aside and behind; the ids are not their indices in the file.
WrittenColmap images() {
  return {
      .images = {{.id = 2, .centre = {0, 0, 0}}, {.id = 0, .centre = {500, 0, 5}}, {.id = 900, .centre = {0, 0, 10}}},
      .points = {}};
}

std::uint32_t seenBy(std::size_t point) { return point < kSheet ? kFront : kBack; }
/// Direction towards the image that saw the point.
Vec3 facing(std::size_t point) { return {0, 0, point < kSheet ? -1.0f : 1.0f}; }

template <class T>
void put(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string views() {
  std::string bytes;
  put(bytes, std::uint64_t{2 * kSheet});
  for (std::size_t i = 0; i < 2 * kSheet; ++i) {
    const bool twice = i % 3 == 0;
    put(bytes, std::uint32_t{twice ? 2u : 1u});
    for (int k = 0; k < (twice ? 2 : 1); ++k) put(bytes, seenBy(i));
  }
  return bytes;
}

enum class Normals { none, right, every5thWrong };

void writeCloud(const std::filesystem::path& file, Normals normals) {
  std::ofstream out(file);
  out << "ply\nformat ascii 1.0\nelement vertex " << 2 * kSheet
      << "\nproperty float x\nproperty float y\nproperty float z\n";
  if (normals != Normals::none) out << "property float nx\nproperty float ny\nproperty float nz\n";
  out << "end_header\n";
  for (std::size_t i = 0; i < 2 * kSheet; ++i) {
    const std::size_t in = i % kSheet;
    out << (i < kSheet ? 0 : 5) + 0.1 * static_cast<double>(in % kSide) << ' ' << 0.1 * static_cast<double>(in / kSide)
        << " 5";
    const bool turned = normals == Normals::every5thWrong && i % 5 == 0;
    if (normals != Normals::none) out << " 0 0 " << (turned ? -1 : 1) * facing(i).z;
    out << '\n';
  }
}

void writeBytes(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

/// The workspace of a dense reconstruction.
void writeWorkspace(const std::filesystem::path& folder, Normals normals) {
  writeColmap(folder / "sparse", images());
  writeCloud(folder / "fused.ply", normals);
  writeBytes(folder / "fused.ply.vis", views());
}

class Remarks final : public LogListener {
 public:
  void said(std::string_view line) override { text += std::string(line) + '\n'; }
  void progressed(std::string_view, double) override {}
  std::string text;
};

std::string refusal(const std::filesystem::path& file) {
  const std::string said = errorOf<FileError>([&] { readCloud(file); });
  return said.empty() ? "read" : said.substr(file.parent_path().string().size() + 1);
}

}  // namespace

TEST_CASE("a fused cloud without normals gets them from the images that saw its points, by image index") {
  const ScratchFolder folder;
  writeWorkspace(folder.path(), Normals::none);
  const StoredCloud stored = readCloud(folder / "fused.ply");
  REQUIRE(stored.cloud.size() == 2 * kSheet);
  REQUIRE(stored.cloud.hasNormals());
  for (std::size_t i = 0; i < stored.cloud.size(); ++i)
    CHECK(glm::distance(stored.cloud.normals[i], facing(i)) < 1e-5f);
  CHECK(stored.cameras.size() == 3);
  CHECK(stored.lost == std::vector<std::string>{"which images saw each point"});
  CHECK(findUp(stored.cloud).up == UpAxis::minusY);
  CHECK(cloudFormats().toRead(folder / "fused.ply").name == "COLMAP dense");
  CHECK(contentsOf(folder / "fused.ply").elements.at(0).count == 2 * kSheet);
}

TEST_CASE("normals that face away from their views are flipped, and the others stay unchanged, bit by bit") {
  const ScratchFolder folder;
  for (const Normals normals : {Normals::right, Normals::every5thWrong}) {
    writeWorkspace(folder.path(), normals);
    Log log(true);
    Remarks remarks;
    log.listen(&remarks);
    const PointCloud cloud = readCloud(folder / "fused.ply", &log).cloud;
    for (std::size_t i = 0; i < cloud.size(); ++i) CHECK(cloud.normals[i] == facing(i));
    const bool turned = remarks.text.find("58 normals faced away") != std::string::npos;
    CHECK_MESSAGE(turned == (normals == Normals::every5thWrong), remarks.text);
  }
}

TEST_CASE("a model in the cloud's own folder is used; without a model or views the cloud is read unchanged") {
  const ScratchFolder folder;
  writeCloud(folder / "fused.ply", Normals::none);
  writeBytes(folder / "fused.ply.vis", views());
  Log log(true);
  Remarks remarks;
  log.listen(&remarks);
  CHECK_FALSE(readCloud(folder / "fused.ply", &log).cloud.hasNormals());
  CHECK(remarks.text.find("fused.ply: its views are not used: there is no model") != std::string::npos);

  writeColmap(folder.path(), images());
  CHECK(readCloud(folder / "fused.ply").cloud.hasNormals());

  std::filesystem::remove(folder / "fused.ply.vis");
  CHECK(cloudFormats().toRead(folder / "fused.ply").name == "PLY");
  CHECK_FALSE(readCloud(folder / "fused.ply").cloud.hasNormals());
}

TEST_CASE("a sculpted cloud is saved beside the original, and one saved over it ignores the views") {
  const ScratchFolder folder;
  writeWorkspace(folder.path(), Normals::right);
  CHECK(whereToSave(folder / "fused.ply") == folder / "fused-sculpted.ply");
  PointCloud cloud = readCloud(folder / "fused.ply").cloud;
  cloud.positions.resize(10);
  cloud.normals.assign(10, Vec3(1, 0, 0));
  cloud.exactPositions.clear();
  saveKeeping(folder / "fused.ply", cloud);
  const PointCloud again = readCloud(folder / "fused.ply").cloud;
  CHECK(again.size() == 10);
  CHECK(again.normals[3] == Vec3(1, 0, 0));
}

TEST_CASE("views truncated at any byte are refused with the byte and advice") {
  const ScratchFolder folder;
  writeWorkspace(folder.path(), Normals::right);
  const std::string whole = views();
  for (std::size_t size = 0; size < whole.size(); size += size < 64 ? 1 : 37) {
    CAPTURE(size);
    writeBytes(folder / "fused.ply.vis", whole.substr(0, size));
    const std::string message = refusal(folder / "fused.ply");
    CHECK_MESSAGE(message.starts_with("fused.ply.vis: byte "), message);
    CHECK_MESSAGE(message.find("fuse fused.ply again with COLMAP, or remove this file") != std::string::npos, message);
  }
}

TEST_CASE("invalid views are refused, and allocate no memory") {
  const ScratchFolder folder;
  writeWorkspace(folder.path(), Normals::right);
  const auto with = [&](std::size_t at, auto value, const std::string& expected) {
    std::string bytes = views();
    std::memcpy(bytes.data() + at, &value, sizeof value);
    writeBytes(folder / "fused.ply.vis", bytes);
    checkSaid(refusal(folder / "fused.ply"), expected);
  };
  for (const std::uint64_t lie : {std::uint64_t{0}, std::uint64_t{2 * kSheet + 1}, ~std::uint64_t{0}})
    with(0, lie, fmt::format("fused.ply.vis: byte 0: has the views of {} points, and fused.ply has 288;...", lie));
  with(8, ~std::uint32_t{0}, "fused.ply.vis: byte ...");  // views that overlap the others
  with(12, std::uint32_t{3},
       "fused.ply.vis: byte 12: point 1 was seen by image 3, counted from 0, and the model has 3;...");
  with(12, std::uint32_t{2}, "read");
  writeBytes(folder / "fused.ply.vis", views() + 'x');
  checkSaid(refusal(folder / "fused.ply"),
            fmt::format("fused.ply.vis: byte {}: has data after the views...", views().size()));
  // A long list of existing views: only its length is wrong.
  std::string bytes = views().substr(0, 8);
  put(bytes, std::uint32_t{1 << 20});
  bytes.resize(bytes.size() + 4 * ((1 << 20) - 1));
  writeBytes(folder / "fused.ply.vis", bytes);
  checkSaid(refusal(folder / "fused.ply"), "fused.ply.vis: byte 8: ends within the 1048576 views of point 1;...");
}

}  // namespace palpate::test::colmap_dense_test
