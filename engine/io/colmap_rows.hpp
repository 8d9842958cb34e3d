// The rows of a COLMAP model's files; text and binary files have the same rows in the same order.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include <fmt/format.h>

namespace palpate {

inline constexpr std::size_t kUnknownCount = ~std::size_t{0};

struct CameraModel {
  std::string_view name;
  std::size_t parameters;
};

/// Thrown for a camera in a binary file whose model has an unknown number of parameters.
struct UnknownModel {
  explicit UnknownModel(std::int32_t which) : number(which) {}
  std::int32_t number;
};

/// The rows of one file, number by number.
class ColmapRows {
 public:
  virtual ~ColmapRows() = default;
  /// Advances to the next row; false after the last.
  virtual bool next() = 0;
  virtual double real(std::string_view what) = 0;
  virtual std::uint64_t whole(std::string_view what) = 0;
  virtual std::uint32_t id(std::string_view what) = 0;
  virtual std::uint8_t channel() = 0;
  virtual const CameraModel& cameraModel() = 0;
  /// Whether a row of a camera with unknown model has another parameter after `taken` ones.
  virtual bool hasParameter(std::size_t taken) = 0;
  virtual std::string name() = 0;
  /// Skips the observations of an image.
  virtual void skipObservations() = 0;
  /// Number of images that saw the point; each id is followed by an index in the image.
  virtual std::uint64_t track() = 0;
  /// Throws if data follows the end of a row.
  virtual void endRow() = 0;
  [[noreturn]] virtual void fail(std::string_view what) const = 0;
  virtual std::uint64_t count() = 0;

  double finite(std::string_view what) {
    const double value = real(what);
    if (!std::isfinite(value)) fail(fmt::format("{} is {}, not a finite number", what, value));
    return value;
  }
};

inline constexpr std::string_view kCameras = "cameras", kImages = "images", kPoints = "points3D";

/// Whether the text or the binary file exists.
bool hasColmapFile(const std::filesystem::path& folder, std::string_view stem);

/// Prefers the binary file, as COLMAP does. `unknownParameters`: number of parameters of a camera whose model is
/// unknown. Throws FileError without either.
std::unique_ptr<ColmapRows> openColmap(const std::filesystem::path& folder, std::string_view stem,
                                       std::function<void(double)> progress = {},
                                       std::size_t unknownParameters = kUnknownCount);

}  // namespace palpate
