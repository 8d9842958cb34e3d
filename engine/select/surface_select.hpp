// Selections by where points are, and by what they look like. Points are given by number, with positions relative to
// the cloud's origin; lengths are model units. Each builds an index of points by cells, as large as what it searches
// for.
#pragma once

#include <optional>
#include <vector>

#include "engine/core/point_lock.hpp"
#include "engine/select/point_bits.hpp"

namespace palpate {

/// The nearest one of `among`; nothing if there is none.
std::optional<std::size_t> nearestPoint(std::span<const PointState> points, const PointBits& among,
                                        const DVec3& position);

/// Those of `among` nearer than `radius` to one of the positions.
PointBits pointsInBalls(std::span<const PointState> points, const PointBits& among, std::span<const Vec3> centres,
                        double radius, unsigned threads = 0);

/// Weights of locks by number (PointLock::kWhole) of `of`, at r times `radius` from the nearest of the positions: the
/// share (1 - r^2)^falloff of the whole, as a brush has it there. All others have none.
std::vector<std::uint8_t> weightsInBalls(std::span<const PointState> points, const PointBits& of,
                                         std::span<const Vec3> centres, double radius, std::uint32_t falloff,
                                         unsigned threads = 0);

/// `of`, and those of `among` nearer than `radius` to one of it.
PointBits grown(std::span<const PointState> points, const PointBits& among, const PointBits& of, double radius,
                unsigned threads = 0);
/// Those of `of` that are not nearer than `radius` to one of `among` that is not in it.
PointBits shrunk(std::span<const PointState> points, const PointBits& among, const PointBits& of, double radius,
                 unsigned threads = 0);

/// Those of `among` that are reached from `seeds` in steps shorter than `reach` from one to the next.
PointBits connectedWith(std::span<const PointState> points, const PointBits& among, const PointBits& seeds,
                        double reach, unsigned threads = 0);

/// Weights of locks by number (PointLock::kWhole): whole for `of`, and for those of `among` within `width` of it less
/// the farther they are, down to none.
std::vector<std::uint8_t> withRim(std::span<const PointState> points, const PointBits& among, const PointBits& of,
                                  double width, unsigned threads = 0);
/// Means of the weights of the existing points nearer than `radius`, which count less the farther they are. What is
/// locked wholly stays so: rims become wider outwards.
std::vector<std::uint8_t> softened(std::span<const PointState> points, std::span<const std::uint8_t> weights,
                                   double radius, unsigned threads = 0);
/// Twice as steep a rim, in the same place: repeated, all points are wholly locked or free.
std::vector<std::uint8_t> sharpened(std::span<const std::uint8_t> weights);

/// Largest differences that count as alike; empty: any.
struct Likeness {
  std::optional<double> normal_deg;  ///< angle between the normals; a point without a normal is like none
  std::optional<int> color;          ///< in red, green and blue each, of 255
};
/// Those of `among` that are like that point.
PointBits pointsLike(std::span<const PointState> points, const PointBits& among, const PointState& point,
                     const Likeness& likeness, unsigned threads = 0);

}  // namespace palpate
