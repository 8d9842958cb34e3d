// Parameters of a scene that change while it runs.
#include "engine/matter/matter_parameters.hpp"

#include <algorithm>

#include "tests/matter/matter_scenes.hpp"
#include "tests/says.hpp"

namespace palpate::parameters_test {

TEST_CASE("parameters have the values of the scene, and setting one changes only that one") {
  MatterScene scene;
  std::vector<std::string> names;
  for (const SimulationParameter& parameter : parametersOf(scene)) {
    names.push_back(parameter.name);
    CHECK(parameter.value >= parameter.low);
    CHECK(parameter.value <= parameter.high);
  }
  CHECK(names == std::vector<std::string>{"viscosity_Pa_s", "cohesion_N_m", "gravity_x_m_s2", "gravity_y_m_s2",
                                          "gravity_z_m_s2", "gain"});
  for (const Matter matter : {Matter::water, Matter::sand, Matter::soft}) {
    scene = {};
    scene.matter = matter;
    for (const SimulationParameter& parameter : parametersOf(scene)) {
      CAPTURE(parameter.name);
      MatterScene changed = scene;
      const double value = (parameter.low + 3 * parameter.high) / 4;
      setParameter(changed, parameter.name, value);
      CHECK(changed != scene);
      std::vector<SimulationParameter> expected = parametersOf(scene);
      std::ranges::find(expected, parameter.name, &SimulationParameter::name)->value = value;
      CHECK(parametersOf(changed) == expected);
      setParameter(changed, parameter.name, parameter.value);
      CHECK(changed == scene);
    }
  }
}

TEST_CASE("an unknown parameter, or a value outside its bounds, is refused with the valid ones") {
  MatterScene scene;
  const MatterScene before = scene;
  const auto refused = [&](std::string_view name, double value) {
    try {
      setParameter(scene, name, value);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("taken");
  };
  CHECK(says(refused("friction", 0.5), "is not a parameter of water"));
  CHECK(says(refused("spacing_mm", 5), "parameters are viscosity_Pa_s, cohesion_N_m"));
  CHECK(says(refused("viscosity_Pa_s", -1), "viscosity_Pa_s: is -1; it must be from 0 to 50"));
  CHECK(says(refused("gravity_y_m_s2", std::nan("")), "gravity_y_m_s2: is nan"));
  CHECK(scene == before);
}

}  // namespace palpate::parameters_test
