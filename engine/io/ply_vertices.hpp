// Converts rows of scalars, from all three encodings, to the arrays of a point cloud.
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

/// Treatment of rows whose position is not a finite number below 1e30.
enum class BadRows : std::uint8_t { leaveOut, refuse };

/// Receives packed rows (scalars in the order of the header, without lists) and sorts their columns into a PointCloud:
/// x y z; nx ny nz; red green blue [alpha], also as diffuse_red or r, case-insensitive and with the aliases of
/// sharedColumnName(); all others become an Attribute. The scale of colours is determined by all of their numbers
/// (ColorScale).
class PlyVertices final : public PlyRowSink {
 public:
  /// Throws FileError at the element's line if x, y or z is missing. Logs which properties are lost.
  PlyVertices(const std::filesystem::path& file, const PlyElement& vertex, Log* log,
              BadRows badRows = BadRows::leaveOut);

  std::size_t rowBytes() const override { return rowBytes_; }
  void reserve(std::uint64_t promised) override;
  /// With BadRows::refuse, returns the first row whose position or normal is not finite. Otherwise points without a
  /// finite position are left out, and normals that are not finite count as missing.
  std::optional<BadRow> append(const std::byte* rows, std::size_t count, bool swapBytes) override;

  /// Declares that colours stored as floats are integer steps, as in text without a decimal point: 1 is nearly black.
  void countColorSteps() { colorSteps_ = true; }

  /// Row numbers (from 0, ascending) that are left out.
  const std::vector<std::uint64_t>& leftOut() const { return leftOut_; }
  /// "3 points without a finite position below 1e30", "colours finer than 8 bits a channel"; empty if all is kept.
  std::vector<std::string> lost() const;

  /// Returns the cloud. Normals are normalised; zero normals are replaced by that of the nearest point that has one. If
  /// more than a tenth are zero, the cloud counts as having no normals, so that they are estimated.
  PointCloud finish(Log* log);

 private:
  enum class Role { position, normal, color, extra };
  struct Column {
    std::size_t offset;
    ScalarType type;
    Role role;
    std::size_t index;  // component, or index in cloud_.extra
    std::string name;
  };
  std::vector<std::string> lostPoints() const;
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
  /// Colours whose scale is not known yet; empty if they are bytes.
  bool rawColors_ = false, wholeColors_ = true, colorSteps_ = false;
  BareVector<std::array<float, 4>> raw_;
  std::size_t count_ = 0;
  std::uint64_t rows_ = 0;  // including those left out
  std::vector<std::uint64_t> leftOut_;
  bool hasFineColors_ = false;
  std::uint64_t darkColors_ = 0;  // number of colours that are NaN
  std::vector<std::size_t> zeroNormals_;
  PointCloud cloud_;
};

}  // namespace palpate
