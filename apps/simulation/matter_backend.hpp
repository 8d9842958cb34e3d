// Choice of the machine that simulates matter, shared by simulate and bench.
#pragma once

#include <memory>

#include "apps/cli/context.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_lattice.hpp"

namespace palpate {

/// Back ends that simulate matter.
std::vector<std::string> matterBackends();
/// The given one or, for `auto`: vulkan, or cpu if there is only a software driver.
std::string chooseMatterBackend(const Context& context, const std::string& name);
/// Starts a simulation on that back end, with the program's number of threads. Throws Error as planOf() does.
std::unique_ptr<MatterSimulation> startMatter(Context& context, const std::string& backend, const MatterScene& scene,
                                              MatterOptions options = {});
/// The same for an existing soft body, and the points that it carries (SoftWorld).
std::unique_ptr<MatterSimulation> startSoft(Context& context, const std::string& backend, const MatterScene& scene,
                                            const MatterOptions& options, SoftSolid solid,
                                            std::span<const SurfacePlace> points);

}  // namespace palpate
