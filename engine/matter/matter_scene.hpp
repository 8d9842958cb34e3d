// Description of a scene of matter, and what its simulation needs: checked before anything runs.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

enum class Matter { water, sand, soft };
inline constexpr std::array<std::pair<std::string_view, Matter>, 3> kMatters{
    {{"water", Matter::water}, {"sand", Matter::sand}, {"soft", Matter::soft}}};

/// Shape of a soft body without a model.
enum class SoftShape {
  box,
  ball,
  sculpture  ///< shape of makeShape(), filled like a scan
};
inline constexpr std::array<std::pair<std::string_view, SoftShape>, 3> kSoftShapes{
    {{"box", SoftShape::box}, {"ball", SoftShape::ball}, {"sculpture", SoftShape::sculpture}}};

/// A ball that a hand holds by a spring and a damper.
struct MatterTool {
  double radius_mm = 0;  ///< 0: no tool
  double mass_kg = 0;    ///< mass of the simulated body; at least half of the mass of the displaced matter

  bool operator==(const MatterTool&) const = default;
};

/// Fields are in the units of the file (engine/matter/matter_scene_file.hpp), which uses the same names. Axes are
/// right-handed; the box extends from 0 to `box_mm`, and y is up unless gravity says otherwise.
struct MatterScene {
  Matter matter = Matter::water;
  DVec3 box_mm{100};  ///< inner size, mm
  /// Size of the initial fill of a corner, at rest. A soft body is placed in the middle of the floor, as large as fits
  /// into this size. mm
  DVec3 fill_mm{100, 50, 100};
  DVec3 fill_at_mm{0};  ///< corner of the fill instead of 0; not for a soft body, mm
  /// Spacing of particles or nodes at rest: each represents a cube of that size. An integral number of particle layers
  /// fills the requested size, so the actual spacing may be a little smaller (particleSpacing_mm()). mm
  double spacing_mm = 5;
  double density_kg_m3 = 1000;   ///< bulk density at rest, kg/m^3
  double viscosity_Pa_s = 1e-3;  ///< dynamic viscosity; not for sand, Pa s
  double cohesion_N_m = 0;       ///< cohesion that holds drops together and makes them round; only for water, N/m
  double friction = 0.5;         ///< Coulomb's coefficient of grains or a soft body, and walls; not for water, 1
  double young_Pa = 2e4;         ///< Young's modulus; only for soft bodies, Pa
  double poisson = 0.45;         ///< Poisson's ratio, from 0 to 0.49; only for soft bodies, 1
  SoftShape shape = SoftShape::box;
  /// File of a closed cloud: the surface of a soft body, instead of `shape`; or a static model in water or sand, where
  /// `builtin:NAME` names an analytic shape. Empty: none.
  std::string model;
  DVec3 model_mm{0};                 ///< box into which the static model is scaled to fit; 0: half of the box, mm
  std::optional<DVec3> model_at_mm;  ///< centre of the underside of that box; default: centre of the floor, mm
  double hole_mm = 0;  ///< widest hole of the model that is closed, as by a soap film, mm; 0: three spacings
  std::optional<std::array<DVec3, 2>> pinned_mm;  ///< corners of a box in which nodes of a soft body are fixed, mm
  DVec3 gravity_m_s2{0, -9.81, 0};                ///< m/s^2
  std::uint32_t substeps = 0;                     ///< number in a step of kMatterStep_s; 0: as many as needed
  MatterTool tool;
  double gain = 1;                 ///< ratio of the force that the hand feels to the simulated force, 1
  std::array<bool, 3> periodic{};  ///< axes with periodic boundaries instead of walls; not in files

  bool operator==(const MatterScene&) const = default;
};

/// The box that the static model fits into: its lowest and highest corner, mm.
std::array<DVec3, 2> modelBox_mm(const MatterScene& scene);

/// Default tool of a scene without one: a ball with a radius of three spacings, or less in a narrow box, as heavy as
/// the matter it displaces.
MatterTool usualTool(const MatterScene& scene);

/// Default viscosity of soft bodies: with one as low as water's they would oscillate for minutes.
inline constexpr double kSoftViscosity_Pa_s = 3;

/// Edge of the cube that a particle represents, such that all cubes together have the volume of the fill: at most
/// spacing_mm; equal to it for soft bodies, and if the sides of the fill are multiples of it.
double particleSpacing_mm(const MatterScene& scene);

/// Length of a step.
inline constexpr double kMatterStep_s = 1e-3;

inline constexpr std::uint32_t kMaxSubsteps = 1000;

/// Memory limit of a machine that is not known yet: a scene is planned without a limit.
inline constexpr std::uint64_t kAnyMemory = ~std::uint64_t{0};

/// Derived quantities of a scene.
struct MatterPlan {
  UVec3 lattice{0};  ///< number of particle layers along each side of the fill
  DVec3 apart_m{0};  ///< initial distance between layers
  std::uint64_t particles = 0;
  std::uint64_t bytes = 0;     ///< approximate
  std::uint32_t substeps = 1;  ///< per step
  double substep_s = kMatterStep_s;
  double spacing_m = 0;         ///< spacing of particles at rest: edge of the cube that one represents
  double mass_kg = 0;           ///< mass of a particle
  double speedOfSound_m_s = 0;  ///< speed of sound of the simulated matter, far below the real one

  /// Kinetic energy of `count` particles at the speed of sound: above it the simulation has diverged.
  double mostKinetic_J(std::size_t count) const {
    return static_cast<double>(count) * mass_kg * speedOfSound_m_s * speedOfSound_m_s / 2;
  }
};

/// Throws an Error that begins with the field and states its bounds if the scene cannot be simulated within
/// `memory_bytes`.
MatterPlan planOf(const MatterScene& scene, std::uint64_t memory_bytes = kAnyMemory);

/// Initial positions of the particles of a scene, m: a cubic lattice from the corner at 0, half a spacing from the
/// walls; grains are slightly displaced from it. Throws as planOf().
std::vector<Vec3> placesAtRest(const MatterScene& scene, std::uint64_t memory_bytes = kAnyMemory);

/// Names of the built-in scenes.
std::vector<std::string_view> matterSceneNames();
/// Throws Error with the valid names.
MatterScene matterSceneNamed(std::string_view name);

}  // namespace palpate
