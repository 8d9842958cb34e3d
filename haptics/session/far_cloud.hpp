// A cloud on another machine, of which only the points around the hands are here.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/up.hpp"
#include "haptics/information_age.hpp"
#include "haptics/server_file.hpp"

namespace palpate {

class FarTouch;
struct BackendSetup;

/// Properties of all its points, as its server has measured them. Model units.
struct FarFacts {
  PointExtent extent;
  double spacing = 0, wideSpacing = 0;
  double noise = 0;  ///< spacings
  UpAxis up = UpAxis::y;
  double edge = 0;     ///< of the bricks in which its points are sent
  bool moves = false;  ///< the points are sent again and again, in real time
  std::string matter;  ///< scene of simulated particles, as sceneText() has it; empty: the points are of a surface
  std::uint64_t standing = 0;  ///< the last points: they stand in such a scene, and are sent once
  bool operator==(const FarFacts&) const = default;
};

/// Number of restarts of a motion since it is served, and the reason of the last one.
struct Restarts {
  std::uint32_t count = 0;
  std::string why;
};

/// Counts of its transmission.
struct FarCounts {
  std::uint64_t updates = 0;                         ///< of the known points
  std::uint64_t points = 0;                          ///< received, in total
  std::uint64_t samples = 0;                         ///< received from the network
  std::uint64_t resumed = 0;                         ///< times that everything was requested again
  std::uint64_t servers = 1;                         ///< successive ones
  std::uint64_t restarts = 0;                        ///< of the motion at the server
  std::size_t bricks = 0, known = 0, mostKnown = 0;  ///< bricks and points known now; maximum of points
  std::uint64_t sent = 0;                            ///< states of points that hands here have changed
  std::uint64_t resent = 0;                          ///< pieces of their strokes sent more than once
  bool delivered = true;                             ///< the server has taken all of their strokes
  double silent_s = 0, longestSilent_s = 0;
  std::uint64_t pings = 0, answered = 0;
  std::optional<double> roundTrip_ms;
};

/// Number of ticks, and of those at which the surface may depend on unknown points.
struct UnknownTicks {
  std::uint64_t ticks = 0, without = 0;
};

/// Fetches the points around the hands, on threads of its own, during its lifetime.
class FarCloud {
 public:
  virtual ~FarCloud() = default;
  /// The back end that requests and feels them, for one session at a time; this must outlive it. Throws Error,
  /// ConfigError.
  virtual std::unique_ptr<FarTouch> makeTouch(const BackendSetup& setup) = 0;
  /// The points are sent again and again, in real time.
  virtual bool moves() const = 0;
  /// Age of the information, which limits the force.
  virtual const InformationAge& known() const = 0;
  virtual FarCounts counts() const = 0;
  /// Its server accepts strokes.
  virtual bool isSculptable() const = 0;
  /// Throws the permanent failure, if there is one.
  virtual void check() const = 0;
  /// Log messages since the last call, the first few of them, to be shown elsewhere, too. Thread-safe.
  virtual std::vector<std::string> takeSaid() = 0;
  /// The file of its server; null: unknown.
  virtual ServerFile* file() { return nullptr; }
};

}  // namespace palpate
