#include "engine/matter/matter_bounds.hpp"

#include "engine/core/error.hpp"

namespace palpate {

void requireBetween(std::string_view field, double value, double least, double most) {
  if (!(value >= least && value <= most))
    throw Error("{}: is {}; it must be from {:g} to {:g}", field, value, least, most);
}

void requireBetween(std::string_view field, const DVec3& value, double least, const DVec3& most) {
  for (int k = 0; k < 3; ++k)
    if (!(value[k] >= least && value[k] <= most[k]))
      throw Error("{}: is {} along {}; it must be from {:g} to {:g}", field, value[k], "xyz"[k], least, most[k]);
}

void requireSubsteps(const MatterScene& scene, double needed, std::string_view remedy) {
  if (needed > kMaxSubsteps)
    throw Error("spacing_mm: needs {:.0f} substeps of a step of {} s, {} at most; use a larger one, {}", needed,
                kMatterStep_s, kMaxSubsteps, remedy);
  if (scene.substeps != 0 && scene.substeps < needed)
    throw Error("substeps: is {}; this scene needs {:.0f} (or 0: automatic)", scene.substeps, needed);
}

}  // namespace palpate
