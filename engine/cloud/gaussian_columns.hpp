// Reads and changes the numbers of one Gaussian in its row.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "engine/cloud/gaussian_harmonics.hpp"
#include "engine/cloud/gaussian_records.hpp"

namespace palpate {

inline constexpr std::string_view kRestName = "f_rest_";

/// position = to + scale * rotation * (position - from).
class GaussianMotion {
 public:
  GaussianMotion(const DQuat& rotation, const DVec3& from, const DVec3& to, double scale = 1);

  DVec3 operator()(const DVec3& position) const {
    if (!isRotated() && scale_ == 1) return position + (to_ - from_);
    return to_ + scale_ * (rotation_ * (position - from_));
  }
  /// Rotations below 1e-4 rad are negligible, and scales as near to 1: quaternions, harmonics and sizes then stay as
  /// they are, bit by bit.
  bool isRotated() const { return harmonics_.has_value(); }
  const DQuat& rotation() const { return rotation_; }
  const HarmonicRotation& harmonics() const { return *harmonics_; }
  double scale() const { return scale_; }

 private:
  DQuat rotation_;
  DVec3 from_, to_;
  double scale_;
  std::optional<HarmonicRotation> harmonics_;
};

/// The columns of records by meaning. Refers to the records.
class GaussianColumns {
 public:
  /// All columns that GaussianRecords requires must be there.
  explicit GaussianColumns(const GaussianRecords& records);

  DVec3 center(const std::byte* row) const { return three(center_, row); }
  Vec3 logScales(const std::byte* row) const;  ///< of a 2D Gaussian the third is -100
  DVec4 rotation(const std::byte* row) const;  ///< w x y z, of any length
  float opacityLogit(const std::byte* row) const { return static_cast<float>(load(opacity_, row)); }
  DVec3 color(const std::byte* row) const { return three(color_, row); }  ///< harmonic of degree 0
  /// Number of harmonics of degree 1 and more in whole degrees up to 3, and the coefficients of one.
  std::size_t harmonics() const;
  DVec3 harmonic(const std::byte* row, std::size_t k) const;

  void setCenter(std::byte* row, const DVec3& center) const;
  /// Moves, rotates and scales it, with its normal, if it has one, and its colours by direction.
  void move(std::byte* row, const GaussianMotion& motion) const;
  /// Makes it larger by e^log.
  void scale(std::byte* row, double log) const;
  /// Gives it the colour of a point, 0 to 255, and leaves what depends on the direction.
  void paint(std::byte* row, const std::array<std::uint8_t, 4>& color) const;

 private:
  using Column = const GaussianRecords::Column*;
  static double load(Column column, const std::byte* row);
  static void store(Column column, std::byte* row, double value);
  static DVec3 three(const std::array<Column, 3>& columns, const std::byte* row) {
    return {load(columns[0], row), load(columns[1], row), load(columns[2], row)};
  }
  static void setThree(const std::array<Column, 3>& columns, std::byte* row, const DVec3& values);

  std::array<Column, 3> center_, color_, logScales_, normal_;  // null: it has no such column
  std::array<Column, 4> rotation_;
  Column opacity_;
  std::vector<Column> rest_;  // channel after channel; empty unless all are floats, and of three channels
};

}  // namespace palpate
