// Files of Gaussians, plain and packed for the web: identified by their header, read in every encoding, refused with
// line or byte, and never overwritten by points.
#include "engine/io/known_formats.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "engine/cloud/gaussian_records.hpp"
#include "engine/cloud/gaussian_surface.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/io/saving.hpp"
#include "engine/io/zip_archive.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/gaussian_bytes.hpp"
#include "tests/io/npy_bytes.hpp"
#include "tests/near.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test::gaussian_format_test {

using namespace gaussian;

namespace {

StoredCloud read(const std::string& content) { return readingFile("a.ply", content); }

constexpr int kSplats = 600;
constexpr float kDeviation = 0.08f;

/// Evenly distributed on a sphere of radius 1 (a spiral).
DVec3 onBall(int k) {
  const double z = 1 - (2.0 * k + 1) / kSplats, around = std::numbers::pi * (3 - std::sqrt(5.0)) * k;
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(around), r * std::sin(around), z};
}

template <class T>
void put(std::string& out, T value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string splatBall() {
  std::string out;
  for (int k = 0; k < kSplats; ++k) {
    for (int axis = 0; axis < 3; ++axis) put(out, static_cast<float>(onBall(k)[axis]));
    for (int axis = 0; axis < 3; ++axis) put(out, kDeviation);
    out += "\xc8\x64\x32\xff\xff\x80\x80\x80";  // 200 100 50, opaque, not rotated
  }
  return out;
}

std::string gzipped(const std::string& text) {
  std::string out("\x1f\x8b\x08\0\0\0\0\0\0\3", 10);
  out += npy::plainBlock(text);
  put(out, zipChecksum({reinterpret_cast<const std::byte*>(text.data()), text.size()}));
  put(out, static_cast<std::uint32_t>(text.size()));
  return out;
}

std::string spzBall(std::uint32_t version, std::uint32_t promised = kSplats) {
  std::string out;
  put(out, std::uint32_t{0x5053474e});
  put(out, version);
  put(out, promised);
  out += std::string("\0\x0c\0\0", 4);
  for (int k = 0; k < kSplats; ++k)
    for (int axis = 0; axis < 3; ++axis) {
      const auto fixed = static_cast<std::int32_t>(std::lround(4096 * onBall(k)[axis]));
      out.append(reinterpret_cast<const char*>(&fixed), 3);
    }
  out += std::string(kSplats, '\xff');
  for (int k = 0; k < kSplats; ++k)
    for (const double color : {200.0, 100.0, 50.0})
      out += static_cast<char>(std::lround(((color / 255 - 0.5) / 0.28209479 * 0.15 + 0.5) * 255));
  out += std::string(3 * kSplats, static_cast<char>(std::lround((std::log(kDeviation) + 10) * 16)));
  for (int k = 0; k < kSplats; ++k) {
    if (version == 2) out += "\x80\x80\x80";
    if (version == 3) put(out, std::uint32_t{3} << 30);
  }
  return gzipped(out);
}

/// SuperSplat's compressed PLY, in which the box of each chunk is that of the whole ball.
std::string compressedBall() {
  std::string out = "ply\nformat binary_little_endian 1.0\nelement chunk 3\n";
  for (const char* name : {"min_x", "min_y", "min_z", "max_x", "max_y", "max_z", "min_scale_x", "min_scale_y",
                           "min_scale_z", "max_scale_x", "max_scale_y", "max_scale_z"})
    out += fmt::format("property float {}\n", name);
  out += fmt::format("element vertex {}\n", kSplats);
  for (const char* name : {"position", "rotation", "scale", "color"})
    out += fmt::format("property uint packed_{}\n", name);
  out += "end_header\n";
  const float scale = std::log(kDeviation);
  for (int chunk = 0; chunk < 3; ++chunk)
    for (const float value : {-1.f, -1.f, -1.f, 1.f, 1.f, 1.f, scale, scale, scale, scale, scale, scale})
      put(out, value);
  for (int k = 0; k < kSplats; ++k) {
    const auto part = [&](int axis, int most) {
      return static_cast<std::uint32_t>(std::lround((onBall(k)[axis] + 1) / 2 * most));
    };
    put(out, part(0, 2047) << 21 | part(1, 1023) << 11 | part(2, 2047));
    put(out, std::uint32_t{512} << 20 | 512u << 10 | 512u);  // w is the largest component
    put(out, std::uint32_t{0});
    put(out, std::uint32_t{0xc86432ff});
  }
  return out;
}

void checkBall(const StoredCloud& stored) {
  REQUIRE(stored.cloud.size() > 200);
  for (std::size_t i = 0; i < stored.cloud.size(); ++i) {
    CHECK(glm::length(stored.cloud.fileCoordinates(i)) == within(1, 0.06));
    CHECK(std::abs(int{stored.cloud.colors[i][0]} - 200) <= 2);
    CHECK(std::abs(int{stored.cloud.colors[i][2]} - 50) <= 2);
  }
}

}  // namespace

TEST_CASE("a file of Gaussians is identified by its header, and gives the same surface in every encoding") {
  const GaussianScene scene = square(20);
  const PointCloud expected = read(fileOf(scene)).cloud;
  CHECK(expected.size() > 300);
  CHECK(expected.hasNormals());
  REQUIRE(expected.hasColors());
  CHECK(expected.colors[0] == std::array<std::uint8_t, 4>{255, 0, 128, 255});
  for (const PlyFormat format : kAllFormats)
    for (const ScalarType type : {ScalarType::f32, ScalarType::f64}) {
      const TemporaryFile file(fileOf(scene, {.format = format, .type = type}));
      CHECK(cloudFormats().toRead(file.path()).name == "3DGS");
      const PointCloud cloud = readCloud(file.path()).cloud;
      CHECK(cloud.positions == expected.positions);
      CHECK(cloud.normals == expected.normals);
      CHECK(cloud.colors == expected.colors);
      CHECK(cloud.extra.empty());
      CHECK(cloud.storedAs.comments == std::vector<std::string>{"comment by hand"});
    }
}

TEST_CASE("files that are not Gaussians are not taken for Gaussians") {
  const auto formatOf = [](const std::string& content) {
    const TemporaryFile file(content);
    return std::string(cloudFormats().toRead(file.path()).name);
  };
  CHECK(formatOf("") == "PLY");
  CHECK(formatOf("ply\nformat ascii 1.0\n") == "PLY");
  const std::string head = "ply\nformat ascii 1.0\n";
  CHECK(formatOf(head + "element vertex 0\nproperty float x\nproperty float scale_0\nend_header\n") == "PLY");
  CHECK(formatOf(head + "element face 0\nproperty float scale_0\nproperty float rot_0\nend_header\n") == "PLY");
  CHECK(formatOf(head + "element vertex 0\nproperty list uchar float scale_0\nproperty float rot_0\nend_header\n") ==
        "PLY");
  CHECK(formatOf(fileOf(square(1))) == "3DGS");
  CHECK(cloudFormats().toRead("/nowhere/at/all.ply").name == "PLY");
  CHECK(cloudFormats().toRead("/tmp").name == "PLY");
  CHECK(contains(cloudFormats().namesRead(), "3DGS"));
  CHECK_FALSE(contains(cloudFormats().endingsWritten(), "3DGS"));
}

TEST_CASE("info of a cloud from Gaussians names its source") {
  const GaussianScene scene = square(10);
  const TemporaryFile file(fileOf(scene));
  const FileContents contents = contentsOf(file.path());
  REQUIRE(contents.elements.size() == 1);
  CHECK(contents.elements[0].name == "Gaussian");
  CHECK(contents.elements[0].count == 100);
  // One f_rest has no degree.
  CHECK(contents.madeFrom == "a splat scene of 100 Gaussians; the points are those of their surface");
  CHECK(readCloud(file.path()).lost.empty());
  const TemporaryFile plain(fileOf(scene, {.leftOut = "f_rest_0"}));
  CHECK(contains(contentsOf(plain.path()).madeFrom, "100 Gaussians of degree 0"));
}

TEST_CASE("points are saved over Gaussians only on request, and then the Gaussians are kept as a backup") {
  const ScratchFolder folder;
  const auto file = folder / "scene.ply";
  const std::string content = fileOf(square(10));
  std::ofstream(file, std::ios::binary) << content;
  CHECK(fileInTheWay(file).losesSomething());
  PointCloud cloud = readCloud(file).cloud;
  forgetGaussians(cloud);
  CHECK(saveKeeping(file, cloud) == folder / "scene.ply.bak");
  std::ifstream kept(folder / "scene.ply.bak", std::ios::binary);
  CHECK(std::string(std::istreambuf_iterator<char>(kept), {}) == content);
  // The file contains points now, which are saved in place.
  CHECK(cloudFormats().toRead(file).name == "PLY");
  CHECK(whereToSave(file) == file);
  CHECK(readCloud(file).cloud.positions == cloud.positions);
}

TEST_CASE("a Gaussian property that is missing or an integer is refused by its name") {
  const GaussianScene scene = square(3);
  for (const char* name : kNames) {
    CAPTURE(name);
    const std::string property = name;
    const bool tells = property == "scale_0" || property == "rot_0";
    const bool needless = property.starts_with("n") || property.starts_with("f_rest") || property == "scale_2";
    for (const PlyFormat format : kAllFormats) {
      const std::string missing = refusalOf("a.ply", fileOf(scene, {.format = format, .leftOut = property}));
      if (!tells && !needless) CHECK(contains(missing, fmt::format(":4: the vertex element has scale_0 and rot_0")));
      if (!tells && !needless) CHECK(contains(missing, fmt::format("no scalar property '{}'", property)));
      if (needless) CHECK(missing == "read");
      const std::string whole = refusalOf("a.ply", fileOf(scene, {.format = format, .otherType = property}));
      if (property.starts_with("n") || property.starts_with("f_rest"))
        CHECK(whole == "read");
      else
        CHECK(contains(whole, fmt::format("'{}' of Gaussians is of type uchar; expected float or double", property)));
    }
  }
}

TEST_CASE("a Gaussian with a non-finite value is not felt and counted, unless the value is unused") {
  const GaussianScene scene = square(8);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (std::size_t column = 0; column < kNames.size(); ++column) {
    CAPTURE(kNames[column]);
    const std::string name = kNames[column];
    const bool used = !name.starts_with("n") && !name.starts_with("f_rest");
    for (const PlyFormat format : kAllFormats)
      for (const double bad : {std::nan(""), -kInfinity}) {
        if (name == "opacity" && bad < 0) continue;  // fully transparent
        const StoredCloud stored =
            read(fileOf(scene, {.format = format, .badRow = 7, .badColumn = column, .badValue = bad}));
        GaussianScene felt = sceneOf(*gaussiansOf(stored.cloud));
        CHECK(leaveOutBad(felt) == (used ? 1 : 0));
      }
  }
}

TEST_CASE("a large file of Gaussians, shared by threads, is read completely") {
  const GaussianScene scene = square(160);  // some megabytes
  const PointCloud expected = surfaceOf(scene).cloud;
  const PointCloud cloud = read(fileOf(scene)).cloud;
  CHECK(cloud.positions == expected.positions);
  CHECK(cloud.normals == expected.normals);
  CHECK(cloud.colors == expected.colors);
}

TEST_CASE("a file of Gaussians cut off at any byte is refused without a crash") {
  const GaussianScene scene = square(2);
  for (const PlyFormat format : kAllFormats) {
    const std::string text = fileOf(scene, {.format = format});
    refuses("a.ply", text, "read");
    for (std::size_t length = 0; length < text.size(); ++length) {
      // Text can only lack its last line end, or digits of its last number.
      const bool inLastNumber = format == PlyFormat::ascii && length > text.find_last_of(' ') + 1;
      if (!inLastNumber) CHECK(refusalOf("a.ply", text.substr(0, length)) != "read");
    }
  }
}

TEST_CASE("a header that promises more Gaussians than follow allocates no memory for them") {
  const std::string text = fileOf(square(1));
  const std::string lie = headerOf({}, 1'000'000'000'000) + text.substr(headerOf({}, 1).size());
  refuses("a.ply", lie, "...the file ends after...");
  CHECK(read(headerOf({}, 0)).cloud.empty());
}

TEST_CASE("other elements beside Gaussians are reported, and skipped up to their end") {
  const std::string text = fileOf(square(3));
  const std::string head = headerOf({}, 9);
  std::string with = head;
  with.insert(with.find("end_header"), "element camera 1\nproperty float f\n");
  const std::string body = text.substr(head.size());
  CHECK(read(with + body + std::string(4, '\0')).lost.back() == "1 camera");
  refuses("a.ply", with + body + std::string(3, '\0'), "...truncated...");
}

TEST_CASE("2D Gaussians, which have two scales, are flat") {
  const PointCloud cloud = read(fileOf(square(20), {.leftOut = "scale_2"})).cloud;
  CHECK(cloud.size() > 300);
  for (std::size_t i = 0; i < cloud.size(); ++i) CHECK(std::abs(cloud.positions[i].z) < 0.3);
}

TEST_CASE("a trained scene of Gaussians is read") {
  const std::filesystem::path file = sharedFile("gaussians_9080.ply");
  if (file.empty()) return;
  CHECK(contentsOf(file).madeFrom ==
        "a splat scene of 9080 Gaussians of degree 3; the points are those of their surface");
  const PointCloud cloud = readCloud(file).cloud;
  CHECK(cloud.size() > 500);
  CHECK(cloud.size() < 9080);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    CHECK(isFinite(cloud.positions[i]));
    CHECK(glm::length(cloud.normals[i]) == near(1, 1e-4));
  }
}

TEST_CASE("points written as Gaussians are read again as the same surface, with normals and colours") {
  const auto sphere = makeShape("sphere", 20);
  PointCloud cloud = sampleShape(*sphere, {.count = 4000, .seed = 1});
  const auto colorAt = [](const DVec3& p) { return DVec3(0.5) + p / 25.0; };
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const DVec3 color = 255.0 * colorAt(cloud.fileCoordinates(i));
    cloud.colors.push_back({static_cast<std::uint8_t>(std::lround(color.x)),
                            static_cast<std::uint8_t>(std::lround(color.y)),
                            static_cast<std::uint8_t>(std::lround(color.z)), 255});
  }
  const double spacing = meanSpacing(cloud);
  const ScratchFolder folder;
  for (const bool ascii : {false, true}) {
    gaussianFormat().write(folder / "a.3dgs.ply", cloud, {.ascii = ascii});
    CHECK(cloudFormats().toRead(folder / "a.3dgs.ply").name == "3DGS");
    CHECK(contentsOf(folder / "a.3dgs.ply").madeFrom.starts_with("a splat scene of 4000 Gaussians of degree 0"));
    const PointCloud back = readCloud(folder / "a.3dgs.ply").cloud;
    CHECK(back.size() > 2000);
    REQUIRE(back.hasNormals());
    REQUIRE(back.hasColors());
    double off = 0, turned_deg = 0, faded = 0;
    for (std::size_t i = 0; i < back.size(); ++i) {
      const DVec3 p = back.fileCoordinates(i);
      off = std::max(off, std::abs(sphere->signedDistance(p)));
      turned_deg = std::max(turned_deg, angleBetween_deg(p, DVec3(back.normals[i])));
      for (int k = 0; k < 3; ++k)
        faded = std::max(faded, std::abs(back.colors[i][static_cast<std::size_t>(k)] - 255 * colorAt(p)[k]));
    }
    MESSAGE("off the surface by ", off / spacing, " spacings, normals by ", turned_deg, " degrees, colours by ", faded,
            " of 255");
    CHECK(off < 0.15 * spacing);
    CHECK(turned_deg < 5);
    CHECK(faded < 8);
  }
  CHECK(gaussianFormat().lacks(cloud).empty());
  CHECK(whereToSave(folder / "a.3dgs.ply") == folder / "a.3dgs.ply");
  cloud.normals.clear();
  CHECK_THROWS_WITH_AS(gaussianFormat().write(folder / "b.3dgs.ply", cloud, {}),
                       doctest::Contains("these points have none"), FileError);
}

TEST_CASE("packed splats are read: .splat, SPZ 2 and 3, SuperSplat's compressed PLY") {
  checkBall(readingFile("a.splat", splatBall()));
  checkBall(readingFile("a.spz", spzBall(2)));
  checkBall(readingFile("a.spz", spzBall(3)));
  checkBall(readingFile("a.ply", compressedBall()));
}

TEST_CASE("packed splats that are truncated, or promise too many, are refused") {
  refuses("a.splat", splatBall().substr(0, 100), "...100 bytes are not a whole number of splats...");
  refuses("a.spz", spzBall(2, 4'000'000'000), "...too few...");
  refuses("a.spz", spzBall(1), "...SPZ of version 1...");
  refuses("a.spz", "NGSP\4", "...version 4 or later...");
  const std::string packed = spzBall(2), compressed = compressedBall();
  refuses("a.spz", packed.substr(0, packed.size() / 2), "...byte...");
  refuses("a.ply", compressed.substr(0, compressed.size() - 10), "...too short...");
}

TEST_CASE("damaged gzip data are refused for what is wrong with them") {
  const std::string good = spzBall(2);
  refuses("a.spz", good, "read");
  std::string flipped = good, longer = good, bomb = good, unended = good;
  flipped[good.size() / 2] ^= 1;
  refuses("a.spz", flipped, "...checksum...");
  ++longer[good.size() - 4];
  refuses("a.spz", longer, "...cannot be unpacked...");
  bomb[good.size() - 1] = '\x7e';
  refuses("a.spz", bomb, "...has an impossible size...");
  bomb[good.size() - 1] = '\x80';
  refuses("a.spz", bomb, "...larger than 2 GiB...");
  unended[10] &= ~1;  // not the last block
  refuses("a.spz", unended, "...cannot be unpacked...");
  std::string named = good.substr(0, 10) + std::string("a.bin\0", 6) + good.substr(10);
  named[3] = 8;
  refuses("a.spz", named, "read");
  refuses("a.spz", named.substr(0, 14) + std::string(8, 'x'), "...ends within its header...");
}

TEST_CASE("Gaussians whose numbers are not finite, or whose rotation is zero, are left out and counted") {
  constexpr std::array<std::pair<std::size_t, double>, 3> kBad{{{0, NAN}, {11, -INFINITY}, {10, NAN}}};
  for (const auto& [column, value] : kBad) {
    CAPTURE(column);
    const gaussian::FileOptions options{.badRow = 5, .badColumn = column, .badValue = value};
    const StoredCloud stored = readingFile("a.ply", gaussian::fileOf(gaussian::square(8), options));
    CHECK_FALSE(stored.cloud.empty());
    GaussianScene felt = sceneOf(*gaussiansOf(stored.cloud));
    CHECK(leaveOutBad(felt) == 1);
  }
  GaussianScene unturned = gaussian::square(8);
  unturned.rotations[3] = Vec4(0);
  CHECK(leaveOutBad(unturned) == 1);
  CHECK(unturned.size() == 63);
}

}  // namespace palpate::test::gaussian_format_test
