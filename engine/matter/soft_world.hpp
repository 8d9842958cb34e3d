// Soft bodies on the CPU.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/core/worker_team.hpp"
#include "engine/matter/matter_simulation.hpp"
#include "engine/matter/soft_body.hpp"
#include "engine/matter/soft_contact.hpp"
#include "engine/matter/soft_model.hpp"
#include "engine/matter/soft_press.hpp"
#include "engine/matter/soft_sculpture.hpp"
#include "engine/matter/tool_body.hpp"

namespace palpate {

/// Points carried by a soft body: a deformable scan.
/// A point moves with the nodes of its cell, by its share of each at rest; at rest it is exactly at its original
/// position. Normals are transformed by F^-T, with deformation gradients interpolated between nodes, so that they are
/// continuous across the cells' faces.
class SoftEmbedding {
 public:
  SoftEmbedding(const SoftLattice& lattice, std::span<const SurfacePlace> points);

  std::size_t size() const { return places_.size(); }
  /// Positions in m, unit normals and velocities in m/s of all points.
  void carry(const SoftBody& body, CloudFrame& frame, WorkerTeam& team);

 private:
  std::vector<SurfacePlace> rest_;
  std::vector<EmbeddedPlace> places_;
  std::vector<glm::mat3> gradients_;  // per node
};

/// Its particles are the nodes of a lattice. Bitwise identical for any number of threads.
class SoftWorld final : public MatterSimulation {
 public:
  /// The body of a scene without a model, or of MatterOptions::soft. Throws Error as planOf() does.
  explicit SoftWorld(const MatterScene& scene, const MatterOptions& options = {});
  /// A filled body (soft_scan.hpp), and the `points` that it carries: surface points in any number and order.
  SoftWorld(const MatterScene& scene, const MatterOptions& options, SoftSolid solid,
            std::span<const SurfacePlace> points);
  /// An existing body, which may be shared.
  SoftWorld(const MatterScene& scene, const MatterOptions& options, std::shared_ptr<const SoftModel> model);

  std::size_t nodes() const { return body_.size(); }
  /// The compression is that of the most compressed cell.
  MatterObservation observe() const override;
  /// The frame of the points that it carries.
  void makeFrame(CloudFrame& frame) override;

  std::optional<double> gpuTime_us() const override { return std::nullopt; }
  std::vector<Vec3> positionsById() const override;
  std::vector<Vec3> velocitiesById() const override;
  void setVelocities(std::span<const Vec3> byId) override;

  void press(std::span<const SurfacePress> presses) override { presses_.assign(presses.begin(), presses.end()); }
  std::span<const PressReport> pressed() const override { return press_.reports(); }
  bool hasSurface() const override { return true; }
  SoftSculpture* sculpture() override { return tools_.empty() ? &sculpture_ : nullptr; }
  /// For the body in its present strain and wall contact. A free body yields as its mass does within a third of a
  /// second. Takes as long as a hundred substeps. (Conjugate gradients; Hestenes, Stiefel 1952.)
  double localCompliance_m_N(const DVec3& place_m, double radius_m, const DVec3& direction) override;

  SoftBody& body() { return body_; }
  const SoftBody& body() const { return body_; }

 private:
  void begin() override;
  void takeParameters() override;
  void placeToolAt(std::size_t tool, const HandPose& hand) override;
  StepReport run(std::span<const HandPose> from, std::span<const HandPose> to) override;
  std::vector<Vec4> pressedPlaces() const override { return {}; }  // no pressure

  /// Runs a substep at whose end `share` of the step is over.
  void substep(std::span<const HandPose> hands, double share, double length_s, StepReport& report);

  WorkerTeam team_;
  std::shared_ptr<const SoftModel> model_;  // owns the lattice that the body refers to
  SoftBody body_;
  SoftContact contact_;
  SoftSurface surface_;
  SoftPress press_;
  SoftSculpture sculpture_;
  std::vector<SurfacePress> presses_;  // presses of the next step
  SoftEmbedding embedding_;
  std::vector<ToolBody> tools_;
};

}  // namespace palpate
