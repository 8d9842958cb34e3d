// COLMAP's folders in both forms, made by hand for the tests of the reader.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>

namespace palpate::test::colmap {

/// Bytes in the layout of the binary files.
class Bytes {
 public:
  template <class T>
  Bytes& put(T value) {
    const std::size_t at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
    return *this;
  }
  Bytes& name(const std::string& text) {
    bytes_ += text;
    bytes_ += '\0';
    return *this;
  }
  const std::string& text() const { return bytes_; }

 private:
  std::string bytes_;
};

inline constexpr std::uint32_t kCamera = 7, kFirstImage = 3, kSecondImage = 900;  // ids have gaps
inline constexpr int kSide = 20;                                                  // points along an edge of a plane

inline double along(int k) { return 0.05 * k; }
inline double reprojectionError(int i) { return 0.5 + 0.001 * i; }

struct Files {
  std::string cameras, images, points;
};

/// A plane at z = 5, seen by two cameras at (0, 0, 0) and (1, 0, 0) that look along +z, y down.
inline Files binary() {
  Bytes cameras, images, points;
  cameras.put(std::uint64_t{1}).put(kCamera).put(std::int32_t{1}).put(std::uint64_t{640}).put(std::uint64_t{480});
  for (const double parameter : {500.0, 510.0, 320.0, 240.0}) cameras.put(parameter);
  images.put(std::uint64_t{2});
  for (const std::uint32_t id : {kSecondImage, kFirstImage}) {
    images.put(id);
    for (const double q : {2.0, 0.0, 0.0, 0.0}) images.put(q);  // not of unit length
    for (const double t : {id == kFirstImage ? 0.0 : -1.0, 0.0, 0.0}) images.put(t);
    images.put(kCamera).name(id == kFirstImage ? "a b.jpg" : "c.jpg").put(std::uint64_t{1});
    images.put(1.5).put(2.5).put(std::int64_t{-1});
  }
  points.put(std::uint64_t{kSide * kSide});
  for (int i = 0; i < kSide * kSide; ++i) {
    points.put(std::uint64_t(10 + 3 * i)).put(along(i % kSide)).put(along(i / kSide)).put(5.0);
    for (const int channel : {i % 256, 10, 200}) points.put(static_cast<std::uint8_t>(channel));
    points.put(reprojectionError(i)).put(std::uint64_t{2});
    for (const std::uint32_t id : {kFirstImage, kSecondImage}) points.put(id).put(std::uint32_t{0});
  }
  return {cameras.text(), images.text(), points.text()};
}

inline Files text() {
  Files files{
      .cameras = "# Camera list\n7 PINHOLE 640 480 500 510 320 240\n", .images = "# Image list\n", .points = ""};
  files.images += "900 2 0 0 0 -1 0 0 7 c.jpg\n1.5 2.5 -1\n3 2 0 0 0 0 0 0 7 a b.jpg\n\n";  // no observations
  for (int i = 0; i < kSide * kSide; ++i)
    files.points += fmt::format("{} {} {} 5 {} 10 200 {} 3 0 900 0\n", 10 + 3 * i, along(i % kSide), along(i / kSide),
                                i % 256, reprojectionError(i));
  return files;
}

inline void write(const std::filesystem::path& folder, const Files& files, const std::string& form) {
  std::ofstream(folder / ("cameras." + form), std::ios::binary) << files.cameras;
  std::ofstream(folder / ("images." + form), std::ios::binary) << files.images;
  std::ofstream(folder / ("points3D." + form), std::ios::binary) << files.points;
}

}  // namespace palpate::test::colmap
