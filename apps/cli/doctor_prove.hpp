// `palpate doctor --prove`, and the proof that a session in real time needs.
#pragma once

#include <cstdio>

#include "apps/cli/context.hpp"

namespace palpate {

/// What `palpate doctor --speed` measures.
/// Measures for at most three seconds, longer on a busy machine, and prints as a table: the ticks that a servo loop
/// reaches, and a tick with an edit of a million points on the CPU and on a GPU other than a software driver.
Json machineSpeed(std::FILE* out, Context& context);

/// Proves the GPU named by `gpu` (DeviceOptions), with other subgroup sizes if it is wrong with the best one, remembers
/// the results, and prints them as tables unless `out` is null.
/// A driver that hangs is reported like a wrong primitive.
Json gpuProof(std::FILE* out, const std::string& gpu, Validation validation);

/// Ends the program if a proof has left a thread in a driver that hangs.
void endAfterProof(const Json& proof);

/// The proof of that GPU by a process of its own, which a driver may crash: the names of the wrong primitives, or
/// kNoProof. Throws GpuError if it could not be made, as for a GPU that is lost in between: nothing is remembered.
std::string proveInOwnProcess(const std::string& gpu);

}  // namespace palpate
