// Which machine moves matter: what simulate and bench share.
#pragma once

#include <memory>

#include "apps/cli/context.hpp"
#include "engine/matter/matter_simulation.hpp"

namespace palpate {

/// Those that this program has.
std::vector<std::string> matterBackends();
/// The one that is named or, for `auto`, vulkan where there is a GPU and cpu where there is none but a software driver.
std::string chooseMatterBackend(const Context& context, const std::string& name);
/// Memory that a simulation may take there, bytes.
std::uint64_t matterMemory(Context& context, const std::string& backend);
/// Throws Error as planOf() does.
std::unique_ptr<MatterSimulation> startMatter(Context& context, const std::string& backend, const MatterScene& scene,
                                              MatterOptions options = {});

}  // namespace palpate
