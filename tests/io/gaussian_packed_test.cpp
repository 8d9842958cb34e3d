// Gaussian splats as they are packed for the web, and Gaussians with invalid numbers.
#include <cmath>
#include <numbers>

#include "engine/io/zip_archive.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/io/gaussian_bytes.hpp"
#include "tests/io/npy_bytes.hpp"
#include "tests/near.hpp"

namespace palpate::test::gaussian_packed_test {
namespace {

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
    REQUIRE_FALSE(stored.lost.empty());
    CHECK(stored.lost[0] == "1 Gaussian whose numbers are not finite or whose rotation is zero");
  }
  GaussianScene unturned = gaussian::square(8);
  unturned.rotations[3] = Vec4(0);
  CHECK(readingFile("a.ply", gaussian::fileOf(unturned)).lost[0].starts_with("1 Gaussian whose"));
}

}  // namespace palpate::test::gaussian_packed_test
