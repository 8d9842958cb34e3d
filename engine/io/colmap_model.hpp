// A sparse reconstruction as COLMAP keeps it in a folder: cameras, images with the places that they were taken from,
// and points with the images that saw them (Schoenberger and Frahm 2016, "Structure-from-motion revisited"; the files
// are those of COLMAP's manual, "Output Format").
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

struct ColmapCamera {
  std::uint32_t id = 0;
  std::string model;                    ///< "PINHOLE" and so on
  std::uint64_t width = 0, height = 0;  ///< pixels
  std::vector<double> parameters;       ///< as the model has them; of a model that is not known as many as there are
};

inline constexpr std::size_t kNoCamera = ~std::size_t{0};  ///< of an image whose camera's model cannot be read

struct ColmapImage {
  std::uint32_t id = 0;
  DVec3 center{0};                      ///< where it was taken, model units
  DVec3 right{0}, down{0}, forward{0};  ///< axes of the camera, unit
  std::size_t camera = kNoCamera;       ///< place in the list of cameras
  std::string name;
};

struct ColmapPoint {
  DVec3 position{0};  ///< model units
  std::array<std::uint8_t, 3> color{};
  double error = 0;                   ///< of its projections, pixels; negative where nobody knows
  std::vector<std::uint32_t> images;  ///< places in the list of images, one for each that saw it
};

/// How many of each a folder says that it has.
struct ColmapCounts {
  std::uint64_t cameras = 0, images = 0, points = 0;
};

struct ColmapModel {
  std::vector<ColmapCamera> cameras;
  std::vector<ColmapImage> images;
};

bool isColmapFolder(const std::filesystem::path& path);
/// The folder of a model that `path` is, or one of its files (cameras.txt, images.bin and so on); else `path`.
std::filesystem::path colmapFolderOf(const std::filesystem::path& path);
/// Whether a folder says where images were taken, as that of any part of a reconstruction does.
bool hasColmapImages(const std::filesystem::path& folder);

/// Reads no points, and no more of text than its lines. Throws FileError.
ColmapCounts countColmap(const std::filesystem::path& folder);

/// Cameras and images. Throws FileError with the place of what is wrong: what ends too early or goes on too long,
/// numbers that are none, what is there twice, what is referred to and is not there. Points need no camera: of a model
/// that is not known text has as many parameters as the line has, and binary as many as make the file come out even.
ColmapModel readColmapImages(const std::filesystem::path& folder);

/// Calls `visit` with each point in the order of the file, and `progress` with the share that is read. Throws FileError
/// as above.
void readColmapPoints(const std::filesystem::path& folder, const ColmapModel& model,
                      const std::function<void(const ColmapPoint&)>& visit,
                      const std::function<void(double)>& progress = {});

}  // namespace palpate
