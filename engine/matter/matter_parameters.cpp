#include "engine/matter/matter_parameters.hpp"

#include <array>

#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"

namespace palpate {

namespace {

struct Parameter {
  const char* name;
  const char* label;
  const char* unit;
  double (*read)(const MatterScene& scene);
  void (*write)(MatterScene& scene, double value);
  double low, high;
  bool ofWater = true, ofSand = true, ofSoft = true;

  bool isOf(const MatterScene& scene) const {
    if (scene.matter == Matter::soft) return ofSoft;
    return scene.matter == Matter::water ? ofWater : ofSand;
  }
};

template <double MatterScene::*member>
constexpr Parameter numberOf(const char* name, const char* label, const char* unit, double low, double high) {
  return {.name = name,
          .label = label,
          .unit = unit,
          .read = [](const MatterScene& scene) { return scene.*member; },
          .write = [](MatterScene& scene, double value) { scene.*member = value; },
          .low = low,
          .high = high};
}

template <int axis>
constexpr Parameter gravityAlong(const char* name, const char* label) {
  return {.name = name,
          .label = label,
          .unit = "m/s^2",
          .read = [](const MatterScene& scene) { return scene.gravity_m_s2[axis]; },
          .write = [](MatterScene& scene, double value) { scene.gravity_m_s2[axis] = value; },
          .low = -20,
          .high = 20};
}

constexpr Parameter of(Parameter parameter, bool water, bool sand, bool soft) {
  parameter.ofWater = water;
  parameter.ofSand = sand;
  parameter.ofSoft = soft;
  return parameter;
}

constexpr std::array kParameters{
    of(numberOf<&MatterScene::viscosity_Pa_s>("viscosity_Pa_s", "viscosity", "Pa s", 0, 50), true, false, true),
    of(numberOf<&MatterScene::cohesion_N_m>("cohesion_N_m", "cohesion", "N/m", 0, 10), true, false, false),
    of(numberOf<&MatterScene::friction>("friction", "friction of walls", "", 0, 2), false, true, true),
    of(numberOf<&MatterScene::young_Pa>("young_Pa", "Young", "Pa", 1e3, 1e6), false, false, true),
    of(numberOf<&MatterScene::poisson>("poisson", "Poisson", "", 0, 0.49), false, false, true),
    gravityAlong<0>("gravity_x_m_s2", "gravity x"),
    gravityAlong<1>("gravity_y_m_s2", "gravity y"),
    gravityAlong<2>("gravity_z_m_s2", "gravity z"),
    numberOf<&MatterScene::gain>("gain", "gain", "", 0, 1000)};

}  // namespace

std::vector<SimulationParameter> parametersOf(const MatterScene& scene) {
  std::vector<SimulationParameter> parameters;
  for (const Parameter& each : kParameters)
    if (each.isOf(scene))
      parameters.push_back({.name = each.name,
                            .label = each.label,
                            .unit = each.unit,
                            .value = each.read(scene),
                            .low = each.low,
                            .high = each.high});
  return parameters;
}

void setParameter(MatterScene& scene, std::string_view name, double value) {
  std::vector<std::string_view> names;
  for (const Parameter& each : kParameters) {
    if (!each.isOf(scene)) continue;
    names.emplace_back(each.name);
    if (each.name != name) continue;
    if (!(value >= each.low && value <= each.high))
      throw Error("{}: is {:g}; it must be from {:g} to {:g}", name, value, each.low, each.high);
    return each.write(scene, value);
  }
  throw Error("{}: is not a parameter of {} that can be changed while it runs; parameters are {}", name,
              nameOf(kMatters, scene.matter), fmt::join(names, ", "));
}

}  // namespace palpate
