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

/// What becomes of rows whose position is not a finite number below 1e30.
enum class BadRows : std::uint8_t { leaveOut, refuse };

/// Takes packed rows (scalars in the order of the header, lists left out) and sorts their columns into a PointCloud:
/// x y z; nx ny nz; red green blue [alpha], also as diffuse_red or r, in any case and as sharedColumnName() knows them;
/// everything else is carried as an Attribute. What colours' numbers mean, all of them tell together (ColorScale).
class PlyVertices final : public PlyRowSink {
 public:
  /// Throws FileError at the element's line when x, y or z is missing. Says through `log` which properties are lost.
  PlyVertices(const std::filesystem::path& file, const PlyElement& vertex, Log* log,
              BadRows badRows = BadRows::leaveOut);

  std::size_t rowBytes() const override { return rowBytes_; }
  void reserve(std::uint64_t promised) override;
  /// Names the first row whose position or normal is not a finite number where such are refused. Otherwise points
  /// without a position are left out, and normals that are not numbers are missing ones.
  std::optional<BadRow> append(const std::byte* rows, std::size_t count, bool swapBytes) override;

  /// Colours that are stored as real numbers count steps, as text without a point does: 1 is nearly black.
  void countColorSteps() { colorSteps_ = true; }

  /// Numbers of the rows that are left out, from 0 on, in order.
  const std::vector<std::uint64_t>& leftOut() const { return leftOut_; }
  /// "3 points without a finite position"; empty where there are none.
  std::vector<std::string> lost() const;

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
  void resize(std::size_t count);
  void leaveOutBadRows(std::size_t base);
  void moveRow(std::size_t from, std::size_t to);
  void settleColors();
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
  BadRows badRows_;
  /// Colours whose scale is not known yet; empty where they are bytes.
  bool rawColors_ = false, wholeColors_ = true, colorSteps_ = false;
  BareVector<std::array<float, 4>> raw_;
  std::size_t count_ = 0;
  std::uint64_t rows_ = 0;  // with those that are left out
  std::vector<std::uint64_t> leftOut_;
  std::uint64_t darkColors_ = 0;  // that are not numbers
  std::vector<std::size_t> zeroNormals_;
  PointCloud cloud_;
};

}  // namespace palpate
