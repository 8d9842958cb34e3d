// A sparse reconstruction in a COLMAP folder: cameras, images with their poses, and points with the images that saw
// them (Schoenberger and Frahm 2016, "Structure-from-motion revisited"; files as in COLMAP's manual, "Output Format").
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/up.hpp"
#include "engine/core/camera_frustum.hpp"
#include "engine/core/vec.hpp"

namespace palpate {

struct ColmapCamera {
  std::uint32_t id = 0;
  std::string model;                    ///< "PINHOLE" and so on
  std::uint64_t width = 0, height = 0;  ///< pixels
  std::vector<double> parameters;       ///< as defined by the model; for an unknown model all that are present
};

inline constexpr std::size_t kNoCamera = ~std::size_t{0};  ///< for an image whose camera's model cannot be read

struct ColmapImage {
  std::uint32_t id = 0;
  DVec3 center{0};                      ///< camera position, model units
  DVec3 right{0}, down{0}, forward{0};  ///< axes of the camera, unit
  std::size_t camera = kNoCamera;       ///< index in the list of cameras
  std::string name;
};

struct ColmapPoint {
  DVec3 position{0};  ///< model units
  std::array<std::uint8_t, 3> color{};
  double error = 0;                   ///< of its projections, pixels; negative if unknown
  std::vector<std::uint32_t> images;  ///< indices of the images that saw it
};

/// Numbers that a folder declares.
struct ColmapCounts {
  std::uint64_t cameras = 0, images = 0, points = 0;
};

struct ColmapModel {
  std::vector<ColmapCamera> cameras;
  std::vector<ColmapImage> images;
};

struct ColmapFolder {
  std::filesystem::path path;
  std::string chosen;  ///< "sparse/1 of 3 models, with 5,210 points" if it is one of several; else empty
};

/// The folder of a model, given it, one of its files (cameras.txt, images.bin and so on), or a project with models in
/// `sparse` or in folders with numbers, of which the one with the most points is taken; nothing for others.
std::optional<ColmapFolder> findColmap(const std::filesystem::path& path);
/// Whether a folder contains camera poses, as every part of a reconstruction does.
bool hasColmapImages(const std::filesystem::path& folder);

/// Reads no points; of text only counts lines. Throws FileError.
ColmapCounts countColmap(const std::filesystem::path& folder);

/// Cameras and images. Throws FileError with the location for files that are too short or too long, invalid numbers,
/// duplicates and missing references. Points do not need cameras: an unknown model has as many parameters as its line
/// in text, and in binary files the number with which the file size is consistent.
ColmapModel readColmapImages(const std::filesystem::path& folder);

/// Calls `visit` with each point in the order of the file, and `progress` with the share that was read. Throws
/// FileError as above.
void readColmapPoints(const std::filesystem::path& folder, const ColmapModel& model,
                      const std::function<void(const ColmapPoint&)>& visit,
                      const std::function<void(double)>& progress = {});

/// Frusta and orientation of the cameras of a COLMAP model.
/// One per image, in the order of the model, model units; none for an image whose camera has no size or no plausible
/// focal length. Distortion is ignored; for a fisheye lens the angle of a corner is its distance from the principal
/// point over the focal length, limited to 75 degrees.
std::vector<CameraFrustum> frustaOf(const ColmapModel& model);

/// Up axis that the cameras agree on (upOfCameras()).
std::optional<UpAxis> upOf(const ColmapModel& model);

}  // namespace palpate
