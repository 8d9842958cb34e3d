// The gather of a query method before the contact step: it fills the first patch of a tick.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "engine/contact/query_method.hpp"
#include "engine/gpu/command_list.hpp"
#include "shaders/shared/gather.h"

namespace palpate {

/// Inputs of a gather, and the GatheredPatch that it fills.
struct GatherIo {
  shared::CloudView cloud;
  DeviceAddress pose = 0, state = 0, patch = 0;
  float radius = 0;  ///< support radius, model units
};

class Gather {
 public:
  virtual ~Gather() = default;

  /// Capacity of its patch, points.
  virtual std::uint64_t slots() const = 0;
  /// Number of command lists to run one after another, with resume() between them.
  virtual std::uint32_t submissions() const { return 1; }
  virtual void record(CommandList& list, std::uint32_t submission, const GatherIo& io) const = 0;
  /// The host's part after the first submission.
  virtual void resume() const {}
};

/// Maximum number of cells of edge 1 / grid.inverseCell that one gather visits.
std::uint32_t cellsPerGather(const shared::HashGrid& grid, double radius);
/// Guaranteed reach, model units, of a gather over this number of cells a side, for any offset within them.
double widestReach(const shared::HashGrid& grid, std::uint32_t cellsPerSide);
/// Number of rounds for this number of cells.
std::uint32_t gatherRounds(std::uint32_t cells);

/// How a method makes its gather, for a cloud of up to `points` points.
struct GatherKind {
  QueryMethod method;
  std::unique_ptr<Gather> (*make)(Device& device, const shared::HashGrid& grid, double radius, std::uint32_t points);
};
/// The methods other than fused: those of engine/study, or none if palpate is built without PALPATE_STUDY.
std::span<const GatherKind> gatherKinds();

/// The gather of a method, for a cloud of up to `points` points; null for fused. Throws UsageError for a method that
/// this palpate was built without.
std::unique_ptr<Gather> makeGather(Device& device, QueryMethod method, const shared::HashGrid& grid, double radius,
                                   std::uint32_t points);

/// The patch between a gather and the step, on the GPU: a header, segments, points.
Buffer makeGatheredPatch(Device& device, std::uint64_t slots);

}  // namespace palpate
