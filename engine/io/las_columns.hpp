// The points of a LAS file as columns: rows go in from many threads, a cloud comes out.
#pragma once

#include <atomic>
#include <memory>
#include <mutex>

#include "engine/core/bare_vector.hpp"
#include "engine/io/las_layout.hpp"

namespace palpate {

class LasColumns {
 public:
  /// All three must outlive it. `threads`: that grow() and finish() use; 0: one per core.
  LasColumns(const LasHeader& header, const LasPointFormat& format, const std::vector<LasExtraField>& extra,
             unsigned threads = 0);

  unsigned threads() const { return threads_; }
  /// Room for so many points, of which nothing is touched.
  void reserve(std::size_t points);
  /// Room for the rows up to `to`, which take() fills; what is there stays.
  void grow(std::size_t to);
  std::size_t size() const { return size_; }
  /// Rows of points from number `base` on. From any threads, for points that differ.
  void take(const std::byte* rows, std::size_t base, std::size_t count);

  /// Places, colours and attributes, once. What does not come along goes to `lost`, in words; what one step of 8 bits
  /// is in the file's colours to `colorStep`.
  PointCloud finish(std::vector<std::string>& lost, unsigned& colorStep);

 private:
  /// Is made when a value other than zero is met first: what no point has takes no memory.
  struct Column {
    explicit Column(const LasField& of) : field(of), attribute{of.name, of.type, {}} {}
    LasField field;
    std::atomic<bool> used = false, rounded = false;  // a value other than zero; one that its type cannot hold
    Attribute attribute;
    std::mutex making;
  };
  struct ColorBits {
    std::atomic<std::uint32_t> all = 0, unequal = 0;  // bits that are set; and that differ between a value's bytes
  };
  void make(Column& column);
  void takeColors(const std::byte* rows, std::size_t base, std::size_t count);
  void placePoints(PointCloud& cloud);
  void placeColors(PointCloud& cloud, unsigned& colorStep);

  const LasHeader& header_;
  const LasPointFormat& format_;
  unsigned threads_;
  std::vector<std::unique_ptr<Column>> columns_;
  std::size_t size_ = 0, reserved_ = 0;  // points
  BareVector<std::array<std::int32_t, 3>> places_;
  BareVector<std::array<std::uint16_t, 3>> colors_;
  ColorBits colorBits_;
};

}  // namespace palpate
