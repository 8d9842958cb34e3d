// A cloud that somebody else has, of which only what lies around the hands is here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"
#include "haptics/information_age.hpp"

namespace palpate {

class BrickSource;

/// What follows from all of its points, as who has them has measured it. Model units.
struct FarFacts {
  PointExtent extent;
  double spacing = 0, wideSpacing = 0;
  double noise = 0;  ///< spacings
  UpAxis up = UpAxis::y;
  double edge = 0;     ///< of the bricks in which its points come
  bool moves = false;  ///< the points come again and again, against the clock
  std::string
      matter;  ///< of points that are particles: their scene, as sceneText() has it; empty: they are of a surface
  std::uint64_t standing = 0;  ///< of the points, the last ones: they stand in such a scene, and never come again
  bool operator==(const FarFacts&) const = default;
};

/// How often what moves has begun anew since it is served, and why it last did, in words.
struct Restarts {
  std::uint32_t count = 0;
  std::string why;
};

/// How its points came.
struct FarCounts {
  std::uint64_t updates = 0;                         ///< of what is known
  std::uint64_t points = 0;                          ///< that came, in all
  std::uint64_t samples = 0;                         ///< of the network
  std::uint64_t resumed = 0;                         ///< times that what is known was asked for anew
  std::uint64_t servers = 1;                         ///< one after another
  std::uint64_t restarts = 0;                        ///< times that what moves has begun anew there
  std::size_t bricks = 0, known = 0, mostKnown = 0;  ///< bricks and points that are here now; points at most
  std::uint64_t sent = 0;                            ///< states of points that hands here have made
  std::uint64_t resent = 0;                          ///< pieces of their strokes that went more than once
  bool delivered = true;                             ///< all that they have made has been taken
  double silent_s = 0, longestSilent_s = 0;
  std::uint64_t pings = 0, answered = 0;
  std::optional<double> roundTrip_ms;
};

/// Brings the points around the hands on threads of its own, from its beginning to its end.
class FarCloud {
 public:
  virtual ~FarCloud() = default;
  /// Where they are asked for, and felt.
  virtual BrickSource& source() = 0;
  /// How old it is, and so how much of a force it bears.
  virtual const InformationAge& known() const = 0;
  virtual FarCounts counts() const = 0;
  /// Who serves it takes strokes.
  virtual bool isSculptable() const = 0;
  /// Throws what went wrong for good, if anything has.
  virtual void check() const = 0;
  /// What the log was told since the last call, the first few of it: for who shows it elsewhere, too. For any thread.
  virtual std::vector<std::string> takeSaid() = 0;
};

}  // namespace palpate
