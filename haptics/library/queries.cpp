// The C interface: nearest positions, ray casts, and the rows that points come from.
#include <algorithm>
#include <cmath>
#include <span>

#include "engine/core/parallel.hpp"
#include "haptics/library/held_session.hpp"

using namespace palpate;
using namespace palpate::library;

namespace {

/// Rows of three numbers as vectors in double precision.
class VectorRows {
 public:
  VectorRows(const pp_rows* rows, std::uint64_t count, const char* name)
      : rows_(rowsFrom(required(rows, name), false, name)), name_(name) {
    if (count > 0) required(rows_.data, name);
    if (rows_.stride == 0) rows_.stride = static_cast<std::ptrdiff_t>(3 * sizeOf(rows_.type));
  }
  /// Throws UsageError if it is not finite.
  DVec3 at(std::uint64_t row) const {
    const std::byte* const data = rows_.data + static_cast<std::ptrdiff_t>(row) * rows_.stride;
    DVec3 vector;
    for (int k = 0; k < 3; ++k)
      vector[k] = rows_.type == ScalarType::f32
                      ? loadScalar<float>(data + static_cast<std::size_t>(k) * sizeof(float))
                      : loadScalar<double>(data + static_cast<std::size_t>(k) * sizeof(double));
    if (!isFinite(vector))
      throw UsageError("{}: row {}: {}, {}, {} are not finite numbers", name_, row, vector.x, vector.y, vector.z);
    return vector;
  }

 private:
  NumberRows rows_;
  const char* name_;
};

/// Answers `count` questions. question() reads the arguments and returns a function (index, origin, row) that answers
/// that row, with a SurfaceHit or nothing.
template <class Question>
pp_status answered(pp_session session, std::uint64_t count, double max_distance, pp_surface_point* found,
                   Question&& question) {
  if (found) std::ranges::fill(std::span(found, count), pp_surface_point{});
  return lookingLong(session, [&](OpenSession& open) {
    if (!(max_distance >= 0)) throw UsageError("max_distance: {} is not a distance of 0 or more", max_distance);
    if (count > 0) required(found, "found");
    const auto answer = question();
    const SurfaceIndex& index = open.surfaceIndex();
    const SessionQueries& queries = open.queries();
    const DVec3 origin = open.model().cloud.origin;
    constexpr std::size_t kBlock = 64;  // questions that a thread takes at a time
    std::vector<std::optional<SurfaceHit>> hits(count);
    const JobStopScope cuts(JobStopScope::cutting());
    parallelBlocks(count, kBlock, queries.threads(), [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) hits[i] = answer(index, origin, i);
    });
    for (std::size_t i = 0; i < count; ++i) found[i] = queries.toldOf(hits[i], origin);
  });
}

// `search`: of the surface, or of the points alone.
using Search = std::optional<SurfaceHit> (SurfaceIndex::*)(const DVec3& x, double within) const;
pp_status nearestTo(pp_session session, const pp_rows* positions, std::uint64_t count, double max_distance,
                    pp_surface_point* found, Search search) {
  return answered(session, count, max_distance, found, [&] {
    return [rows = VectorRows(positions, count, "positions"), max_distance, search](
               const SurfaceIndex& index, const DVec3& origin, std::uint64_t row) {
      return (index.*search)(rows.at(row) - origin, max_distance);
    };
  });
}

}  // namespace

pp_status pp_session_nearest(pp_session session, const pp_rows* positions, uint64_t count, double max_distance,
                             pp_surface_point* found) {
  return nearestTo(session, positions, count, max_distance, found, &SurfaceIndex::nearest);
}

pp_status pp_session_nearest_points(pp_session session, const pp_rows* positions, uint64_t count, double max_distance,
                                    pp_surface_point* found) {
  return nearestTo(session, positions, count, max_distance, found, &SurfaceIndex::nearestPoint);
}

pp_status pp_session_raycast(pp_session session, const pp_rows* origins, const pp_rows* directions, uint64_t count,
                             double max_distance, pp_surface_point* found) {
  return answered(session, count, max_distance, found, [&] {
    return [from = VectorRows(origins, count, "origins"), along = VectorRows(directions, count, "directions"),
            max_distance](const SurfaceIndex& index, const DVec3& origin, std::uint64_t row) {
      const DVec3 direction = along.at(row);
      const double longest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
      if (!(longest > 0)) throw UsageError("directions: row {}: is 0, and so not a direction", row);
      return index.castRay(from.at(row) - origin, glm::normalize(direction / longest), max_distance);
    };
  });
}

pp_status pp_session_rows(pp_session session, pp_row* rows, uint64_t capacity, uint64_t* count) {
  clear(count);
  return lookingLong(session, [&](OpenSession& open) {
    required(count, "count");
    const std::vector<pp_row> all = open.rows();
    if (capacity > 0) {
      required(rows, "rows");
      if (capacity < all.size())
        throw UsageError("capacity: the session has {} points, but there is room for {}", all.size(), capacity);
      std::ranges::copy(all, rows);
    }
    *count = all.size();
  });
}
