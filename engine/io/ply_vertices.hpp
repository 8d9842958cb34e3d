// From rows of scalars, as all three encodings deliver them, to the arrays of a point cloud.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/core/log.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/ply_row_sink.hpp"

namespace palpate {

/// Takes packed rows (scalars in the order of the header, lists left out) and sorts their columns into a PointCloud:
/// x y z; nx ny nz; red green blue [alpha], also as diffuse_red or r; everything else is carried as an Attribute.
class PlyVertices final : public PlyRowSink {
 public:
  /// Throws FileError at the element's line when x, y or z is missing. Says through `log` which properties are lost.
  PlyVertices(const std::filesystem::path& file, const PlyElement& vertex, Log* log);

  std::size_t rowBytes() const override { return rowBytes_; }
  void reserve(std::uint64_t promised) override;
  /// Names the first row whose position or normal is not a finite number.
  std::optional<BadRow> append(const std::byte* rows, std::size_t count, bool swapBytes) override;

  /// The cloud. Normals are made unit length; where some are zero they are taken from the nearest point that has one,
  /// and where more than a tenth are zero the cloud counts as having none, so that they get estimated.
  PointCloud finish(Log* log);

 private:
  enum class Role { position, normal, color, extra };
  struct Column {
    std::size_t offset;
    ScalarType type;
    Role role;
    std::size_t index;  // component, or place in cloud_.extra
    std::string name;
  };
  std::vector<Column>::iterator named(std::string_view name);
  bool assignGroup(Role role, std::initializer_list<std::string_view> names);
  template <class T, bool kSwap>
  void appendColumn(const Column& column, const std::byte* rows, std::size_t base, std::size_t count);
  std::optional<BadRow> checkPositions(std::size_t base) const;
  std::optional<BadRow> normalise(std::size_t base);
  void placeOrigin();

  std::filesystem::path file_;
  std::vector<Column> columns_;
  std::size_t rowBytes_ = 0;
  bool wide_ = false;  // positions need more than single precision
  bool hasNormals_ = false, hasColors_ = false;
  std::size_t count_ = 0;
  std::vector<std::size_t> zeroNormals_;
  PointCloud cloud_;
};

}  // namespace palpate
