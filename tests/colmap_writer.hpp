// Folders of reconstructions in COLMAP's text format.
#pragma once

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

struct WrittenImage {
  std::uint32_t id = 1;
  DVec3 centre{0};
  DQuat turn{1, 0, 0, 0};  ///< from the world to the camera
};

struct WrittenPoint {
  DVec3 place{0};
  std::array<int, 3> color{100, 100, 100};
  double error_px = 0.5;
  std::vector<std::uint32_t> images;  ///< ids
};

struct WrittenColmap {
  std::string camera = "1 PINHOLE 640 480 500 510 310 250";  ///< of all images
  std::vector<WrittenImage> images;
  std::vector<WrittenPoint> points;
};

inline void writeColmap(const std::filesystem::path& folder, const WrittenColmap& written) {
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "cameras.txt") << written.camera << '\n';
  std::ofstream images(folder / "images.txt");
  for (const WrittenImage& image : written.images) {
    const DQuat& q = image.turn;
    const DVec3 t = -(q * image.centre);
    images << fmt::format("{} {} {} {} {} {} {} {} {} {}.jpg\n\n", image.id, q.w, q.x, q.y, q.z, t.x, t.y, t.z,
                          written.camera.substr(0, written.camera.find(' ')), image.id);
  }
  std::ofstream points(folder / "points3D.txt");
  for (std::size_t i = 0; i < written.points.size(); ++i) {
    const WrittenPoint& point = written.points[i];
    points << fmt::format("{} {} {} {} {} {} {} {}", i + 1, point.place.x, point.place.y, point.place.z, point.color[0],
                          point.color[1], point.color[2], point.error_px);
    for (const std::uint32_t image : point.images) points << ' ' << image << " 0";
    points << '\n';
  }
}

}  // namespace palpate
