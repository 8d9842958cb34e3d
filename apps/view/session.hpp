// The session of the window, configured by the window's settings.
#pragma once

#include <memory>
#include <string>

#include "apps/cli/context.hpp"
#include "apps/cli/probe_overlays.hpp"
#include "apps/cli/sharing_options.hpp"
#include "engine/contact/query_method.hpp"
#include "haptics/session/drawn_follower.hpp"
#include "haptics/session/interactive_session.hpp"

namespace palpate {

// Settings that can change while touching.

/// The brush, which keeps its options while the stylus only feels.
struct BrushSettings : BrushConfig {
  BrushSettings() { color = {220, 40, 40}; }
  bool sculpts = false;

  bool operator==(const BrushSettings&) const = default;
};
struct FeelSettings {
  SurfaceKind surface = SurfaceKind::average;
  QueryMethod method = QueryMethod::fused;
  double friction = SurfaceConfig{}.friction;
  double stiffness_N_per_mm = ForceOptions{}.stiffness_N_per_mm, damping_N_s_per_mm = ForceOptions{}.damping_N_s_per_mm,
         maxForce_N = ForceOptions{}.maxForce_N, handGain = ForceOptions{}.handGain;

  bool operator==(const FeelSettings&) const = default;
};

/// Options of the window.
struct WindowOptions {
  SessionConfig config;        ///< its model changes
  bool exceedsMemory = false;  ///< read a model that needs more memory than is free without a question
  bool backendIsOpen = false;  ///< measured for each model: the CPU may answer sooner than the GPU
  NetworkOptions network;      ///< of ROS topics
  bool hidesCamera = false;    ///< do not publish the camera to the participants of the joined session
  std::string ros;             ///< name under which the camera is published to ROS; empty: not published
  std::string hand;            ///< name of the hand in the joined session; empty: the machine's name
  StreamConfig stream;         ///< of recorded depth cameras
  UndoBudget undo{.bytes = 1ull << 30};
  InteractiveOptions live;
};

/// Pointer to the drawn copy of a session's points; a base class, as it is set while the session is constructed.
struct DrawnSlot {
  DrawnFollower* follower = nullptr;
};

/// A model in the window.
class WindowSession final : private DrawnSlot, public InteractiveSession {
 public:
  /// Builds everything on the GPUs. `sight`: device that draws the picture. Throws Error.
  WindowSession(Context& context, Device& sight, Model model, const WindowOptions& options, const BrushSettings& brush,
                const FeelSettings& feel);

  DrawnCloud& drawn();
  /// DrawnFollower::frames().
  std::uint64_t frames() const { return follower->frames(); }
  /// Number of present points: of a model that moves, those of its newest frame, or of the map made of its frames.
  std::uint64_t presentPoints() const {
    return follower->frames() > 0 ? follower->framePoints() : history().points().present();
  }
  std::string backendName() const { return config().backend.name; }

  const BrushSettings& brushSettings() const { return brush_; }
  const FeelSettings& feel() const { return feel_; }
  /// Model units; has no brush while the surface is only felt.
  HeldTool heldTool() const;
  /// Extra depth, mm, that a hand without a device must aim at to sculpt to a given depth: the brush acts only from its
  /// yield depth on, where the spring pulls the hand back. 0 where the hand only feels.
  double givenWay_mm() const;
  void setBrushSettings(const BrushSettings& brush);
  void setFeel(const FeelSettings& feel);

 private:
  BrushSettings brush_;
  FeelSettings feel_;
};

}  // namespace palpate
