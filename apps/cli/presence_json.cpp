#include "apps/cli/presence_json.hpp"

namespace palpate {

Json toJson(std::span<const SeenHand> hands) {
  Json all = Json::array();
  for (const SeenHand& hand : hands)
    all.push_back({{"name", hand.name},
                   {"number", hand.number},
                   {"position", vectorJson(hand.place.position)},
                   {"proxy", vectorJson(hand.place.proxy)},
                   {"touching", hand.place.touching},
                   {"sculpts", hand.place.sculpts},
                   {"age_s", hand.age_s}});
  return all;
}

Json toJson(std::span<const SeenCamera> cameras) {
  Json all = Json::array();
  for (const SeenCamera& camera : cameras) {
    const DQuat& turn = camera.place.turn;
    all.push_back({{"name", camera.name},
                   {"position", vectorJson(camera.place.position)},
                   {"orientation", {turn.w, turn.x, turn.y, turn.z}},
                   {"fov_deg", glm::degrees(camera.place.fovY_rad)},
                   {"aspect", camera.place.aspect},
                   {"age_s", camera.age_s}});
  }
  return all;
}

}  // namespace palpate
