// The points of a LAS file as columns: rows go in from many threads, a cloud comes out.
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
  /// All three must outlive it. `threads`: that grow() and finish() use; 0: one per core.
  LasColumns(const LasHeader& header, const LasPointFormat& format, const std::vector<LasExtraField>& extra,
             unsigned threads = 0);

  unsigned threads() const { return threads_; }
  /// Seconds for which threads waited until now for memory that another one made ready, all together.
  double waited_s() const;
  /// Addresses for so many points, of which nothing is touched.
  void reserve(std::size_t points);
  /// Rows up to `to` are about to be taken; what is there stays. Their memory is fetched while they are. No rows are
  /// taken meanwhile.
  void makeRoom(std::size_t to);
  /// Rows of points from number `base` on, for which there is room. From any threads, for points that differ.
  void take(const std::byte* rows, std::size_t base, std::size_t count);

  /// Places, colours, normals and attributes, once, of as many points as there is room for. What does not come along
  /// goes to `lost`, in words; what one step of 8 bits is in the file's colours to `colorStep`; to `withoutNormal` who
  /// has none though the cloud has.
  PointCloud finish(std::vector<std::string>& lost, unsigned& colorStep, std::vector<std::size_t>& withoutNormal);

 private:
  /// Is made when a value with a bit that is set is met first: what no point has takes no memory.
  struct Column {
    explicit Column(const LasField& of) : field(of), attribute{of.name, of.type, {}} {}
    LasField field;
    std::atomic<bool> used = false, rounded = false;  // a value other than zero; one that its type cannot hold
    Attribute attribute;
    GrowingArray<std::byte> bytes{attribute.data};
    std::mutex making;
  };
  struct ColorBits {
    std::atomic<std::uint32_t> all = 0, unequal = 0;  // bits that are set; and that differ between a value's bytes
  };
  /// Of the numbers of places.
  struct Range {
    static constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
    static constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();
    std::array<std::int32_t, 3> least{kMax, kMax, kMax}, most{kMin, kMin, kMin};
    void include(const Range& other);
  };
  /// Whether there is a normal that is no vector; that is zero; that is as good as of unit length, but not exactly.
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
  std::vector<std::unique_ptr<Column>> columns_;  // but those of normals
  std::vector<LasField> normals_;                 // three, or none
  std::size_t size_ = 0, reserved_ = 0;           // points
  PointCloud cloud_;  // the positions hold the bits of the file's whole numbers until the points are placed
  BareVector<std::array<std::uint16_t, 3>> colors_;
  GrowingArray<Vec3> places_{cloud_.positions}, vectors_{cloud_.normals};
  GrowingArray<std::array<std::uint16_t, 3>, BareAllocator<std::array<std::uint16_t, 3>>> fineColors_{colors_};
  // What threads write apart from what all of them read for each block.
  alignas(64) ColorBits colorBits_;
  NormalKinds normalKinds_;
  alignas(64) std::mutex ranging_;
  Range range_;
};

}  // namespace palpate
