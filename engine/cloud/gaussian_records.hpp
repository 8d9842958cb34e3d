// The Gaussians of a file, bit by bit, beside the points of their surface: what is written back.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "engine/cloud/gaussian_scene.hpp"
#include "engine/cloud/point_cloud.hpp"

namespace palpate {

/// Rows of numbers, one for each Gaussian, in native byte order. The columns have the names of 3DGS: x y z, f_dc_0 to
/// 2, opacity, scale_0 to 2 (2D Gaussians: to 1) and rot_0 to 3, which are floats or doubles, and any others. A cloud
/// that was read from Gaussians has them as its baggage, which follows its points (edited_gaussians.hpp).
struct GaussianRecords final : FormatBaggage {
  struct Column {
    std::string name;
    ScalarType type;
    std::size_t offset;  ///< in a row, bytes
  };

  GaussianRecords(std::vector<Column> columns, BareVector<std::byte> rows);

  std::size_t size() const { return rows.size() / rowBytes; }
  /// Null if there is none.
  const Column* find(std::string_view name) const;
  const std::byte* row(std::size_t i) const { return rows.data() + i * rowBytes; }

  const std::vector<Column> columns;  ///< without gaps, in the order of the file
  const std::size_t rowBytes;
  const BareVector<std::byte> rows;
};

/// "9080 Gaussians of degree 3"; without the degree if no degree has `rest` coefficients in f_rest.
std::string gaussiansInWords(std::uint64_t count, std::size_t rest);
std::string gaussiansInWords(const GaussianRecords& records);

/// Null if the cloud was not read from Gaussians.
const GaussianRecords* gaussiansOf(const PointCloud& cloud);
/// Leaves the points alone, without the Gaussians.
void forgetGaussians(PointCloud& cloud);

/// Numbers may be infinite or NaN.
GaussianScene sceneOf(const GaussianRecords& records, unsigned threads = 0);
/// Leaves out Gaussians whose numbers are not finite, or whose rotation is zero, and returns their number. Makes
/// opacities finite: full opacity has an infinite logit.
std::size_t leaveOutBad(GaussianScene& scene);

/// The surface of the Gaussians as points that have them as their baggage, and otherwise what `as` says.
PointCloud surfacePointsOf(std::shared_ptr<const GaussianRecords> records, StoredAs as, unsigned threads = 0);

}  // namespace palpate
