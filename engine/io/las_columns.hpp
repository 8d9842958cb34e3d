// The points of a LAS file as columns: many threads add rows, the result is a cloud.
#pragma once

#include <array>
#include <atomic>
#include <limits>
#include <memory>
#include <mutex>

#include "engine/core/bare_vector.hpp"
#include "engine/core/large_array.hpp"
#include "engine/io/las_layout.hpp"

namespace palpate {

class LasColumns {
 public:
  /// The references must outlive the object. `threads`: used by finish(); 0: one per core.
  LasColumns(const LasHeader& header, const LasPointFormat& format, const std::vector<LasExtraField>& extra,
             unsigned threads = 0);

  unsigned threads() const { return threads_; }
  /// Sum over all threads: seconds of waiting for memory prepared by another thread.
  double waited_s() const;
  /// Reserves address space for `points` points without touching it.
  void reserve(std::size_t points);
  /// Prepares memory for rows up to `to`, which are added next; existing rows stay. Pages are fetched concurrently with
  /// take(). Not concurrent with take().
  void makeRoom(std::size_t to);
  /// Adds rows of points starting at number `base`, for which there must be room. From any thread, for disjoint points.
  void take(const std::byte* rows, std::size_t base, std::size_t count);

  /// Finishes positions, colours, normals and attributes of all points that there is room for; call once. Sets
  /// `colorStep` to the size of an 8-bit step in the file's colours;
  /// `withoutNormal` receives the points without a normal if the cloud has normals.
  PointCloud finish(unsigned& colorStep, std::vector<std::size_t>& withoutNormal);

 private:
  /// Allocated when the first non-zero value is met: an unused attribute takes no memory.
  struct Column {
    explicit Column(const LasField& of) : field(of), attribute{of.name, of.type, {}} {}
    LasField field;
    std::atomic<bool> used = false;  // has a non-zero value
    Attribute attribute;
    GrowingArray<std::byte> bytes{attribute.data};
    std::mutex making;
  };
  struct ColorBits {
    std::atomic<std::uint32_t> all = 0, unequal = 0;  // bits that are set; bits that differ between a value's bytes
  };
  /// Range of the integer coordinates.
  struct Range {
    static constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
    static constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();
    std::array<std::int32_t, 3> least{kMax, kMax, kMax}, most{kMin, kMin, kMin};
    void include(const Range& other);
  };
  /// Whether there are normals that are not finite; that are zero; that are not of unit length.
  struct NormalKinds {
    std::atomic<bool> infinite = false, missing = false, scaled = false;
  };
  void make(Column& column);
  void complete(Column& column) { column.bytes.need(size_ * sizeOf(column.field.type)); }
  void takeFew(const std::byte* rows, std::size_t base, std::size_t count, Range& range);
  void takePlaces(const std::byte* rows, std::size_t base, std::size_t count, Range& range);
  void takeNormals(const std::byte* rows, std::size_t base, std::size_t count);
  void takeColors(const std::byte* rows, std::size_t base, std::size_t count);
  void takeColumn(Column& column, const std::byte* rows, std::size_t base, std::size_t count);
  void placePoints();
  void placeColors(unsigned& colorStep);
  std::vector<std::size_t> placeNormals();

  const LasHeader& header_;
  const LasPointFormat& format_;
  unsigned threads_;
  std::vector<std::unique_ptr<Column>> columns_;  // except normals
  std::vector<LasField> normals_;                 // three, or none
  std::size_t size_ = 0, reserved_ = 0;           // points
  PointCloud cloud_;  // until the points are placed, positions hold the bits of the file's integers
  BareVector<std::array<std::uint16_t, 3>> colors_;
  GrowingArray<Vec3> places_{cloud_.positions}, vectors_{cloud_.normals};
  GrowingArray<std::array<std::uint16_t, 3>, BareAllocator<std::array<std::uint16_t, 3>>> fineColors_{colors_};
  // Data that threads write is on other cache lines than data that all of them read for each block.
  alignas(64) ColorBits colorBits_;
  NormalKinds normalKinds_;
  alignas(64) std::mutex ranging_;
  Range range_;
};

}  // namespace palpate
