// Collects the rows of a PLY file of Gaussians.
#pragma once

#include <memory>
#include <vector>

#include "engine/cloud/gaussian_records.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/ply_row_sink.hpp"

namespace palpate {

/// Columns: those that GaussianRecords requires, and any others.
class GaussianRows final : public PlyRowSink {
 public:
  /// Whether the rows are meant as Gaussians, even if incomplete.
  static bool areGaussians(const PlyElement& vertex);

  /// Throws FileError at the element's line if a property is missing or has an integer type.
  GaussianRows(const std::filesystem::path& file, const PlyElement& vertex);

  std::size_t rowBytes() const override { return rowBytes_; }
  std::size_t bytesAtOnce() const override { return std::size_t{64} << 20; }
  void reserve(std::uint64_t promised) override;
  std::optional<BadRow> append(const std::byte* rows, std::size_t count, bool swapBytes) override;

  /// All rows, bit by bit.
  std::shared_ptr<const GaussianRecords> takeRecords() {
    return std::make_shared<const GaussianRecords>(std::move(columns_), std::move(rows_));
  }
  /// Lists of each Gaussian, which are not read.
  const std::vector<std::string>& lists() const { return lists_; }

 private:
  std::vector<GaussianRecords::Column> columns_;
  std::size_t rowBytes_ = 0;
  BareVector<std::byte> rows_;
  std::vector<std::string> lists_;
};

}  // namespace palpate
