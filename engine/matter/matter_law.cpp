#include "engine/matter/matter_law.hpp"

namespace palpate {

std::unique_ptr<MatterLaw> lawOf(const MatterScene& scene, const MatterPlan& plan) {
  return scene.matter == Matter::sand ? sandLaw(scene, plan) : waterLaw(scene, plan);
}

}  // namespace palpate
