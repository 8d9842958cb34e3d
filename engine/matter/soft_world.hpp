// A scene of a soft body, and what it says of itself: MatterWorld's verbs for what is not made of particles.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "engine/core/cloud_frame.hpp"
#include "engine/matter/matter_world.hpp"
#include "engine/matter/soft_contact.hpp"
#include "engine/matter/soft_embedding.hpp"

namespace palpate {

/// For one thread at a time. The same scene and the same hands give the same bytes, for any number of threads.
class SoftWorld {
 public:
  /// The body of a scene without a model. Throws Error as planOf() does.
  explicit SoftWorld(const MatterScene& scene, const MatterOptions& options = {});
  /// A body that was filled (soft_scan.hpp), and `points` that it carries: those of its surface in any number and
  /// order.
  SoftWorld(const MatterScene& scene, const MatterOptions& options, SoftSolid solid,
            std::span<const SurfacePlace> points);

  const MatterPlan& plan() const { return plan_; }
  std::size_t nodes() const { return body_.size(); }
  /// Puts everything back to where it began; tools are placed by the next step.
  void reset();
  /// kMatterStep_s further. `hands`: one for each tool, where they are at the end of the step; the first ones say where
  /// the tools begin.
  void step(std::span<const HandPose> hands = {});

  MatterState state() const { return state_; }
  double time_s() const { return static_cast<double>(steps_) * kMatterStep_s; }
  std::span<const ToolAnswer> answers() const { return answers_; }  ///< of the last step
  double portEnergy_J(std::size_t tool) const { return tools_[tool].portEnergy_J(); }
  const MatterImpulses& impulses() const { return impulses_; }
  /// Compression is that of the cell which has least of its volume.
  MatterObservation observe() const;
  /// Where the points are now: positions in m, normals, velocities in m/s, the time in s.
  void makeFrame(CloudFrame& frame);

  /// How far the surface within `radius_m` of a place (m) gives way along the unit vector `direction` for a force on
  /// it, as the body now is, strained and on the walls that it stands on, m/N: what a servo loop may go on with until
  /// the next step. A body that nothing holds gives way as its mass does within a third of a second. Takes as long as a
  /// hundred substeps, and changes nothing. (Conjugate gradients; Hestenes, Stiefel 1952.)
  double localCompliance_m_N(const DVec3& place_m, double radius_m, const DVec3& direction);

  SoftBody& body() { return body_; }
  const SoftBody& body() const { return body_; }

 private:
  void substep(std::span<const HandPose> from, std::span<const HandPose> to, double share);
  void judge();

  MatterScene scene_;
  MatterPlan plan_;
  WorkerTeam team_;
  std::unique_ptr<const SoftSolid> solid_;  // where it stays, as the body looks at it
  SoftBody body_;
  SoftContact contact_;
  SoftEmbedding embedding_;
  std::vector<ToolBody> tools_;
  std::vector<HandPose> hands_;  // at the end of the last step; empty before the first
  std::vector<ToolAnswer> answers_;
  SoftSums sums_;
  MatterImpulses impulses_;
  MatterState state_ = MatterState::running;
  std::uint64_t steps_ = 0;
};

}  // namespace palpate
