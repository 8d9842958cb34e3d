// Data exchanged between host and device in a tick of the CUDA back end.
#pragma once

#include "shaders/shared/contact.h"

namespace palpate::cu {

/// Slots for the candidates of one gather: the maximum number that a gather visits.
inline constexpr std::uint32_t kMaxSlots = shared::kMaxPatchPoints;
/// Points that one block of the brute force visits.
inline constexpr std::uint32_t kBruteChunk = 4096;

/// The answer to one pose, in mapped host memory. Words may arrive in any order; the sample is complete when its seal
/// matches.
struct Answer {
  shared::ContactSample sample;
  std::uint32_t launchError;  ///< error of a launch from the device; a cudaError_t, 0 if all succeeded
  std::uint32_t unused;
  std::uint64_t step_clocks;   ///< resident kernel: from pose read to answer; of this or the previous answer
  std::uint64_t alive_clocks;  ///< resident kernel: since its start, on the same clock,
  std::uint64_t alive_ns;      ///< and on the global timer, which is too coarse for one step
};

/// The host's question, in mapped host memory. The resident kernel reads all of it at each poll, since every poll is a
/// trip over the bus, and accepts it when the seal matches.
struct alignas(32) Message {
  shared::ContactPose pose;
  std::uint32_t parity;  ///< front half of the cloud
  std::uint32_t stop;
  std::uint32_t sequence;  ///< incremented with each message
  std::uint32_t seal;      ///< the sum of shared::questionShare() of all words before it
};
inline constexpr std::uint32_t kMessageWords = 8;
static_assert(sizeof(Message) == kMessageWords * sizeof(std::uint32_t));

/// The part of one cell's points that a gather visits: numbers first, first + stride, ... into slots of their own.
/// Slots follow the order of cells and of candidates, so the patch does not depend on the kernel that fills them.
struct CellRun {
  std::uint32_t cell;  ///< number in the gather's box, x fastest
  std::uint32_t first, stride, taken;
  std::uint32_t slot;
};

/// The cells that a gather visits.
struct CellBox {
  shared::ivec3 low;
  shared::uvec3 size;
  std::uint32_t cells;
};

/// One gather, as passed between its kernels.
struct Gather {
  shared::vec3 hip;     ///< model units
  shared::vec3 centre;  ///< of the patch, relative to the HIP
  float reach;
  CellBox box;
  std::uint32_t slots;    ///< number in use
  std::uint32_t thinned;  ///< 1: candidates were subsampled
  std::uint32_t runs;     ///< number of cells with candidates, in order
  std::uint32_t longestRun;
};

/// Plan of a two-step query for the host, which then launches the rest.
struct PlanReport {
  std::uint32_t runs, longestRun;
  std::uint32_t sequence;
};

/// Buffers of the back end, in device memory unless noted. Positions in slots are relative to the patch's centre; w is
/// 1 for a point in reach.
struct StepArgs {
  shared::CloudView cloud;
  const Message* message;  ///< mapped host memory
  Answer* answer;          ///< mapped host memory
  PlanReport* report;      ///< mapped host memory
  shared::ContactState* state;
  shared::vec4* spill;  ///< 2 per point that does not fit in shared memory: position, normal
  Gather* gather;
  CellRun* runs;               ///< kPatchMaxCells
  shared::vec4* slots;         ///< 2 per slot: position, normal
  std::uint32_t* chunkCounts;  ///< brute force: points in reach, one count per chunk
  float radius;                ///< support radius, model units
  float friction;              ///< friction coefficient of the proxy
};

inline std::uint32_t bruteChunks(std::uint32_t points) {
  const std::uint32_t chunks = points / kBruteChunk + (points % kBruteChunk != 0);
  return chunks ? chunks : 1;
}

}  // namespace palpate::cu
