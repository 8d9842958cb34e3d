// What a query method does before the contact step: it fills the first patch of a tick.
#pragma once

#include <cstdint>
#include <memory>

#include "engine/contact/query_method.hpp"
#include "engine/gpu/command_list.hpp"
#include "shaders/shared/gather.h"

namespace palpate {

/// What a gather reads, and the GatheredPatch that it fills.
struct GatherIo {
  shared::CloudView cloud;
  DeviceAddress pose = 0, state = 0, patch = 0;
  float radius = 0;  ///< support radius, model units
};

class Gather {
 public:
  virtual ~Gather() = default;

  /// Points that its patch has room for.
  virtual std::uint64_t slots() const = 0;
  /// Command lists that have to run one after another, with resume() between them.
  virtual std::uint32_t submissions() const { return 1; }
  virtual void record(CommandList& list, std::uint32_t submission, const GatherIo& io) const = 0;
  /// The host's part, once the first submission has run.
  virtual void resume() const {}
};

/// Cells of edge 1 / grid.inverseCell that one gather visits at most.
std::uint32_t cellsPerGather(const shared::HashGrid& grid, double radius);
/// The reach, model units, that a gather over so many cells a side has wherever it stands within them.
double widestReach(const shared::HashGrid& grid, std::uint32_t cellsPerSide);
/// Rounds that so many cells are visited in.
std::uint32_t gatherRounds(std::uint32_t cells);

/// The gather of a method, for a cloud of up to `points` points; none for the fused one.
std::unique_ptr<Gather> makeGather(Device& device, QueryMethod method, const shared::HashGrid& grid, double radius,
                                   std::uint32_t points);

/// The patch between a gather and the step, on the GPU: a header, segments, points.
Buffer makeGatheredPatch(Device& device, std::uint64_t slots);

}  // namespace palpate
