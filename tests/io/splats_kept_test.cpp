// Splat scenes that are read and saved: what was not changed is written back bit by bit, whatever is felt of it.
#include <fstream>
#include <limits>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/gaussian_records.hpp"
#include "engine/io/saving.hpp"
#include "tests/content_of.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/gaussian_bytes.hpp"
#include "tests/splat_files.hpp"

namespace palpate::test::splats_kept_test {

namespace {

std::filesystem::path written(const ScratchFolder& folder, const std::string& name, const std::string& bytes) {
  std::ofstream(folder / name, std::ios::binary) << bytes;
  return folder / name;
}

constexpr const char* kOurs = "comment trained by a test\ncomment written by palpate\n";

}  // namespace

TEST_CASE("a splat scene of every degree is saved with the header and the bytes that it came with") {
  for (unsigned degree = 0; degree <= 4; ++degree) {
    CAPTURE(degree);
    const ScratchFolder folder;
    const SplatFile scene = splatBall(degree, 400);
    const StoredCloud stored = readCloud(written(folder, "a.ply", scene.bytes()));
    CHECK(stored.lost.empty());
    CHECK_FALSE(stored.cloud.empty());
    saveKeeping(folder / "b.ply", stored.cloud);
    CHECK((contentOf(folder / "b.ply") == scene.bytes(kOurs)));
    // Nothing that was undone is left.
    auto points = statesOf(stored.cloud);
    points.push_back({.gone = true, .number = points.size(), .parent = 3});
    saveKeeping(folder / "c.ply", editedCloud(stored.cloud, points));
    CHECK((contentOf(folder / "c.ply") == scene.bytes(kOurs)));
  }
}

TEST_CASE("Gaussians that cannot be felt are kept: transparent, oversized, not finite, without a rotation") {
  const ScratchFolder folder;
  SplatFile scene = splatBall(1, 400, {.floaters = 0.05, .faint = 0.5, .huge = 2});
  const auto set = [&](std::size_t row, const char* name, float value) {
    std::memcpy(scene.rows[row].data() + 4 * scene.column(name), &value, 4);
  };
  set(5, "x", std::numeric_limits<float>::quiet_NaN());
  set(6, "scale_1", std::numeric_limits<float>::infinity());
  for (const char* name : {"rot_0", "rot_1", "rot_2", "rot_3"}) set(7, name, 0);
  set(8, "opacity", -std::numeric_limits<float>::infinity());
  set(9, "nx", -0.0f);
  const StoredCloud stored = readCloud(written(folder, "a.ply", scene.bytes()));
  CHECK(stored.lost.empty());
  saveKeeping(folder / "b.ply", stored.cloud);
  CHECK((contentOf(folder / "b.ply") == scene.bytes(kOurs)));
  // Of an edited scene, too, in which they are not finite.
  auto points = statesOf(stored.cloud);
  points[0].gone = true;
  saveKeeping(folder / "c.ply", editedCloud(stored.cloud, points));
  const std::vector<std::size_t> rows = rowsIn(parsedSplats(contentOf(folder / "c.ply")), scene);
  CHECK(rows.size() < scene.rows.size());
  for (const std::size_t kept : {5, 6, 7, 8, 9}) CHECK(std::ranges::find(rows, kept) != rows.end());
}

TEST_CASE("splats of other encodings are saved little-endian in their own types, text as text") {
  const GaussianScene scene = gaussian::square(8);
  for (const ScalarType type : {ScalarType::f32, ScalarType::f64}) {
    const std::string expected = gaussian::fileOf(scene, {.type = type, .otherType = "nx"});
    const std::string body = expected.substr(expected.find("end_header"));
    for (const PlyFormat format : kAllFormats) {
      const ScratchFolder folder;
      const auto file =
          written(folder, "a.ply", gaussian::fileOf(scene, {.format = format, .type = type, .otherType = "nx"}));
      const PointCloud cloud = readCloud(file).cloud;
      writeCloud(folder / "b.ply", cloud);
      const std::string content = contentOf(folder / "b.ply");
      CHECK((content.substr(content.find("end_header")) == body));
      CHECK(contains(content, type == ScalarType::f64 ? "property double f_dc_0" : "property float f_dc_0"));
      CHECK(contains(content, "property uchar nx"));
      saveKeeping(folder / "text.ply", cloud, {.like = file});
      CHECK((contentOf(folder / "text.ply").find("format ascii") != std::string::npos) == (format == PlyFormat::ascii));
      writeCloud(folder / "again.ply", readCloud(folder / "text.ply").cloud);
      const std::string again = contentOf(folder / "again.ply");
      CHECK((again.substr(again.find("end_header")) == body));
    }
  }
}

TEST_CASE("columns in another order, and columns of other programs, are kept as they are") {
  const ScratchFolder folder;
  SplatFile scene = splatBall(0, 300);
  std::swap(scene.names[0], scene.names[scene.names.size() - 1]);  // x last
  for (std::string& row : scene.rows) std::swap_ranges(row.begin(), row.begin() + 4, row.end() - 4);
  scene.names.emplace_back("object_id");
  for (std::size_t i = 0; i < scene.rows.size(); ++i) {
    const auto id = static_cast<float>(i);
    scene.rows[i].append(reinterpret_cast<const char*>(&id), 4);
  }
  const StoredCloud stored = readCloud(written(folder, "a.ply", scene.bytes()));
  CHECK(stored.lost.empty());
  saveKeeping(folder / "b.ply", stored.cloud);
  CHECK((contentOf(folder / "b.ply") == scene.bytes(kOurs)));
}

TEST_CASE("formats that cannot hold Gaussians name them as lost, and fields of the points are named in PLY") {
  const ScratchFolder folder;
  StoredCloud stored = readCloud(written(folder, "a.ply", splatBall(2, 300).bytes()));
  const std::string sentence =
      "390 Gaussians of degree 2, of which the points are the surface (opacity, scale, rotation, colours by the "
      "direction of view)";
  for (const char* name : {"a.las", "a.xyz", "a.pcd", "a.npy"})
    CHECK(lostOnTheWay(stored, cloudFormats().toWrite(name)).back() == sentence);
  for (const char* name : {"a.ply", "a.3dgs.ply"}) {
    const CloudFormat& format = cloudFormats().toWrite(name);
    CHECK(lostOnTheWay(stored, format).empty());
    CHECK(keptOnTheWay(stored, format) == std::vector<std::string>{"all properties"});
  }
  std::string notKept;
  saveKeeping(folder / "b.xyz", stored.cloud, {.notKept = &notKept});
  CHECK(contains(notKept, sentence));
  stored.cloud.extra.push_back({"label", ScalarType::u8, std::vector<std::byte>(stored.cloud.size())});
  saveKeeping(folder / "b.ply", stored.cloud, {.notKept = &notKept});
  CHECK(notKept ==
        "not kept: 'label' of the felt surface (a splat file contains only splats; save a .las file to keep it)");
}

TEST_CASE("a splat scene is saved in its own file, and its former version is kept") {
  const ScratchFolder folder;
  const std::string content = splatBall(0, 300).bytes();
  const auto file = written(folder, "scene.ply", content);
  CHECK(whereToSave(file) == file);
  const FileInTheWay inTheWay = fileInTheWay(file);
  CHECK(inTheWay.losesSomething());  // another program wrote it
  CHECK(inTheWay.sentence() == "scene.ply was not written by palpate");
  const PointCloud cloud = readCloud(file).cloud;
  CHECK(saveKeeping(file, cloud) == folder / "scene.ply.bak");
  CHECK((contentOf(folder / "scene.ply.bak") == content));
  CHECK(cloudFormats().toRead(file).name == "3DGS");
  CHECK_FALSE(fileInTheWay(file).losesSomething());
}

}  // namespace palpate::test::splats_kept_test
