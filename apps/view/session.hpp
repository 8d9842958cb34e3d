// The session behind the window: what a person sets there, as a session is configured with it.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>

#include "apps/cli/context.hpp"
#include "apps/cli/probe_overlays.hpp"
#include "apps/cli/sharing_options.hpp"
#include "engine/contact/query_method.hpp"
#include "haptics/session/drawn_follower.hpp"
#include "haptics/session/live_session.hpp"

namespace palpate {

/// What a person may turn while touching.
struct BrushSettings {
  std::optional<BrushKind> kind;  ///< nothing: only feel
  double radius_mm = 6, strength = 0.5, tau_mm = 0.5, beta = 0.1;
  std::uint32_t falloff = 1;
  std::array<std::uint8_t, 3> color{220, 40, 40};

  bool operator==(const BrushSettings&) const = default;
};
struct FeelSettings {
  SurfaceKind surface = SurfaceKind::average;
  QueryMethod method = QueryMethod::fused;
  double friction = 0;
  double stiffness_N_per_mm = 0.8, damping_N_s_per_mm = 0.002, maxForce_N = kTouchPeakForce_N;

  bool operator==(const FeelSettings&) const = default;
};

/// What the window is opened with.
struct WindowOptions {
  SessionConfig config;      ///< the file of its model changes from model to model
  NetworkOptions network;    ///< that topics of ROS are heard on
  bool hidesCamera = false;  ///< nobody in the session that is joined is told from where the picture is seen
  std::string ros;           ///< under which programs of ROS hear that; empty: none does
  std::string hand;          ///< what others see it called in the session that is joined; empty: as the machine
  StreamConfig stream;       ///< of models that are depth cameras
  std::uint64_t undo_bytes = 1ull << 30;
  LiveOptions live;
};

/// The picture that follows a session, for whoever must know it before the session is there.
struct DrawnSlot {
  DrawnFollower* follower = nullptr;
};

/// A model in the window.
class WindowSession final : private DrawnSlot, public LiveSession {
 public:
  /// Builds everything on the GPUs. `sight`: where the picture is drawn. Throws Error.
  WindowSession(Context& context, Device& sight, Model model, const WindowOptions& options, const BrushSettings& brush,
                const FeelSettings& feel);

  DrawnCloud& drawn();
  /// DrawnFollower::frames().
  std::uint64_t frames() const { return follower->frames(); }
  std::string backendName() const { return config().backend.name; }

  const BrushSettings& brushSettings() const { return brush_; }
  const FeelSettings& feel() const { return feel_; }
  /// Model units; without a brush while the surface is only felt.
  HeldTool heldTool() const;
  /// How much further than it is to sculpt a hand without a device must mean to go, mm: its brush begins where its
  /// spring is so long, which pulls it back. 0 where it only feels.
  double givenWay_mm() const;
  void setBrushSettings(const BrushSettings& brush);
  void setFeel(const FeelSettings& feel);

 private:
  BrushSettings brush_;
  FeelSettings feel_;
};

}  // namespace palpate
