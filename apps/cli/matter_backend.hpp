// Which machine moves matter: what simulate and bench share.
#pragma once

#include <memory>

#include "apps/cli/context.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_lattice.hpp"

namespace palpate {

/// Those that move any.
std::vector<std::string> matterBackends();
/// The one that is named or, for `auto`, vulkan where there is a GPU that moves the scene, and cpu where there is
/// none but a software driver, or shapes are matched.
std::string chooseMatterBackend(const Context& context, const std::string& name, const MatterScene& scene);
/// On that back end, with as many threads as the program may use. Throws Error as planOf() does.
std::unique_ptr<MatterSimulation> startMatter(Context& context, const std::string& backend, const MatterScene& scene,
                                              MatterOptions options = {});
/// The same for a soft body that is there already, and the points that it carries (SoftWorld).
std::unique_ptr<MatterSimulation> startSoft(Context& context, const std::string& backend, const MatterScene& scene,
                                            const MatterOptions& options, SoftSolid solid,
                                            std::span<const SurfacePlace> points);

}  // namespace palpate
