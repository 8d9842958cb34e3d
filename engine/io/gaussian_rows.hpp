// Converts the rows of a PLY file to the Gaussians of a scene.
#pragma once

#include <array>
#include <vector>

#include "engine/cloud/gaussian_scene.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/ply_row_sink.hpp"

namespace palpate {

/// Columns: x y z; f_dc_0 to 2; opacity; scale_0 to 2 (2D Gaussians have no scale_2, and are flat); rot_0 to 3.
class GaussianRows final : public PlyRowSink {
 public:
  /// Whether the rows are meant as Gaussians, even if incomplete.
  static bool areGaussians(const PlyElement& vertex);

  /// Throws FileError at the element's line if a property is missing or has an integer type.
  GaussianRows(const std::filesystem::path& file, const PlyElement& vertex);

  std::size_t rowBytes() const override { return rowBytes_; }
  std::size_t bytesAtOnce() const override { return std::size_t{64} << 20; }
  void reserve(std::uint64_t promised) override;
  /// Uses one thread per core.
  std::optional<BadRow> append(const std::byte* rows, std::size_t count, bool swapBytes) override;

  /// Numbers may be infinite or NaN.
  GaussianScene takeScene() { return std::move(scene_); }
  /// Properties of points that are neither used by a scene nor colours by direction.
  const std::vector<std::string>& unused() const { return unused_; }

 private:
  enum class Group { center, logScale, rotation, opacity, color, none };
  struct Column {
    std::string name;
    std::size_t offset;
    ScalarType type;
    Group group;
    int component;
  };
  struct Range {
    std::size_t begin, end;  // of the rows given
  };
  template <class T, bool kSwap>
  void storeColumn(const Column& column, const std::byte* rows, Range range);
  template <bool kSwap>
  void storeRows(const std::byte* rows, Range range);
  void store(const Column& column, std::size_t i, double value);

  std::vector<Column> columns_;
  std::size_t rowBytes_ = 0;
  std::size_t count_ = 0;  // rows appended before
  GaussianScene scene_;
  std::vector<std::string> unused_;
};

}  // namespace palpate
