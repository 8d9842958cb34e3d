// What a scene of matter is made of, and what a simulation of it will need: looked at before anything runs.
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

/// What a soft body is that has no model.
enum class SoftShape {
  box,
  ball,
  sculpture  ///< that of makeShape(), filled as a scan is
};
inline constexpr std::array<std::pair<std::string_view, SoftShape>, 3> kSoftShapes{
    {{"box", SoftShape::box}, {"ball", SoftShape::ball}, {"sculpture", SoftShape::sculpture}}};

/// What brings a soft body back to its shape.
enum class SoftPreset {
  elastic,        ///< a material in SI units (shaders/shared/soft.h)
  shapeMatching,  ///< geometry alone: cheap, stable at any substep, and not calibrated (shape_matching.hpp)
};
inline constexpr std::array<std::pair<std::string_view, SoftPreset>, 2> kSoftPresets{
    {{"elastic", SoftPreset::elastic}, {"shape-matching", SoftPreset::shapeMatching}}};

/// A ball that a hand holds by a spring and a damper.
struct MatterTool {
  double radius_mm = 0;  ///< 0: there is none
  double mass_kg = 0;    ///< of the simulated body; at least half of that of the matter it displaces

  bool operator==(const MatterTool&) const = default;
};

/// Fields are in the units of the file (engine/io/matter_scene_file.hpp), which has the same names. Axes are
/// right-handed; the box stands from 0 to `box_mm`, and y is up as long as gravity says nothing else.
struct MatterScene {
  Matter matter = Matter::water;
  DVec3 box_mm{100};  ///< inner sides, mm
  /// A corner is filled so far at the beginning, at rest. A soft body stands in the middle of the floor, as
  /// large as fits into this. mm
  DVec3 fill_mm{100, 50, 100};
  DVec3 fill_at_mm{0};  ///< corner of the fill, in place of that at 0; not of a soft body, mm
  /// Of the particles or nodes at rest: one stands for its cube. Layers of particles fill what is asked for, so that
  /// these may be a little nearer to each other (particleSpacing_mm()). mm
  double spacing_mm = 5;
  double density_kg_m3 = 1000;   ///< at rest, of the matter in bulk, kg/m^3
  double viscosity_Pa_s = 1e-3;  ///< dynamic; not of sand, Pa s
  double cohesion_N_m = 0;       ///< what holds drops together and makes them round; of water alone, N/m
  double friction = 0.5;         ///< Coulomb's coefficient of grains or a soft body, and walls; not of water, 1
  double young_Pa = 2e4;         ///< Young's modulus; of soft bodies alone, Pa
  double poisson = 0.45;         ///< Poisson's ratio, from 0 to 0.49; of soft bodies alone, 1
  SoftPreset preset = SoftPreset::elastic;  ///< of soft bodies alone
  /// Of shape matching alone: share of the way back to its shape that matter goes in a substep, from 1e-4 to 0.95, 1.
  /// It stands for no modulus: a body is the stiffer for it the larger its spacing and the shorter its substep.
  double stiffness = 0.5;
  SoftShape shape = SoftShape::box;
  /// File of a closed cloud: the surface of a soft body, in place of the shape; or what stands still in water or sand,
  /// where `builtin:NAME` is an analytic shape, too. Empty: there is none.
  std::string model;
  DVec3 model_mm{0};                 ///< box that such a model fits into, as large as it can; 0: half of the box, mm
  std::optional<DVec3> model_at_mm;  ///< middle of the underside of that box; not there: of the floor, mm
  double hole_mm = 0;  ///< widest hole of the model that is closed as by a soap film, mm; 0: of three spacings
  std::optional<std::array<DVec3, 2>> pinned_mm;  ///< corners of a box in which nodes of a soft body never move, mm
  DVec3 gravity_m_s2{0, -9.81, 0};                ///< m/s^2
  std::uint32_t substeps = 0;                     ///< in a step of kMatterStep_s; 0: as many as it needs
  MatterTool tool;
  double gain = 1;                 ///< of the force that the hand feels over the real one, 1
  std::array<bool, 3> periodic{};  ///< axes without walls, on which what leaves comes in again; not in files

  bool operator==(const MatterScene&) const = default;
};

/// The box that the model of a scene of water or sand fits into: its lowest and highest corner, mm.
std::array<DVec3, 2> modelBox_mm(const MatterScene& scene);

/// For a hand where the scene says no tool: a ball of three spacings' radius, or less in a narrow box, as heavy as
/// what it displaces.
MatterTool usualTool(const MatterScene& scene);

/// Viscosity that soft bodies have where a file says nothing: one as low as water's would let them ring for minutes.
inline constexpr double kSoftViscosity_Pa_s = 3;

/// Side of the cube that a particle stands for, so that all together are the volume of the fill: at most spacing_mm,
/// and that where sides of the fill are whole multiples of it, or of soft bodies.
double particleSpacing_mm(const MatterScene& scene);

/// Length of a step.
inline constexpr double kMatterStep_s = 1e-3;

inline constexpr std::uint32_t kMaxSubsteps = 1000;

/// Memory of a machine that is not known yet: a scene is planned as if there were any.
inline constexpr std::uint64_t kAnyMemory = ~std::uint64_t{0};

/// What a scene comes to.
struct MatterPlan {
  UVec3 lattice{0};  ///< particles along each side of the fill: its layers
  DVec3 apart_m{0};  ///< and how far apart those begin
  std::uint64_t particles = 0;
  std::uint64_t bytes = 0;     ///< about
  std::uint32_t substeps = 1;  ///< in a step
  double substep_s = kMatterStep_s;
  double spacing_m = 0;         ///< of particles at rest: side of the cube that one stands for
  double mass_kg = 0;           ///< of a particle
  double speedOfSound_m_s = 0;  ///< of the simulated matter, far below that of the real one

  /// Of so many particles at the speed of sound: what moves with more is no matter any more.
  double mostKinetic_J(std::size_t count) const {
    return static_cast<double>(count) * mass_kg * speedOfSound_m_s * speedOfSound_m_s / 2;
  }
};

/// Throws Error that begins with the field and says its bounds, for what cannot be simulated within `memory_bytes`.
MatterPlan planOf(const MatterScene& scene, std::uint64_t memory_bytes = kAnyMemory);

/// Where the particles of a scene begin, m: a cubic lattice from the corner at 0, half a spacing from the walls; grains
/// a little beside that. Throws as planOf().
std::vector<Vec3> placesAtRest(const MatterScene& scene, std::uint64_t memory_bytes = kAnyMemory);

/// Names of the scenes that need no file.
std::vector<std::string_view> matterSceneNames();
/// Throws Error with the names that there are.
MatterScene matterSceneNamed(std::string_view name);

}  // namespace palpate
