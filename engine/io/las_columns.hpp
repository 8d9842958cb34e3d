// The points of a LAS file as columns: rows go in from many threads, a cloud comes out.
#pragma once

#include <atomic>
#include <memory>

#include "engine/core/bare_vector.hpp"
#include "engine/io/las_layout.hpp"

namespace palpate {

class LasColumns {
 public:
  /// Both must outlive it.
  LasColumns(const LasHeader& header, const LasPointFormat& format, const std::vector<LasExtraField>& extra);

  /// Room for so many points, of which nothing is touched.
  void reserve(std::size_t points);
  /// Room for the rows up to `to`, which take() fills; what is there stays.
  void grow(std::size_t to);
  std::size_t size() const { return places_.size(); }
  /// Rows of points from number `base` on. From any threads, for points that differ.
  void take(const std::byte* rows, std::size_t base, std::size_t count);

  /// Places, colours and attributes, once. What does not come along goes to `lost`, in words; what one step of 8 bits is
  /// in the file's colours to `colorStep`.
  PointCloud finish(std::vector<std::string>& lost, unsigned& colorStep);

 private:
  struct Column {
    LasField field;
    std::unique_ptr<std::atomic<bool>> used, rounded;  // a value other than zero; one that its type cannot hold
    Attribute attribute;
  };
  struct ColorBits {
    std::atomic<std::uint32_t> all = 0, unequal = 0;  // bits that are set; and that differ between a value's bytes
  };
  void takeColors(const std::byte* rows, std::size_t base, std::size_t count);
  void placePoints(PointCloud& cloud);
  void placeColors(PointCloud& cloud, unsigned& colorStep);

  const LasHeader& header_;
  const LasPointFormat& format_;
  std::vector<Column> columns_;
  BareVector<std::array<std::int32_t, 3>> places_;
  BareVector<std::array<std::uint16_t, 3>> colors_;
  ColorBits colorBits_;
};

}  // namespace palpate
