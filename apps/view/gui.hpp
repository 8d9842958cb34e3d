#pragma once

#include <set>
#include <span>
#include <string_view>
#include <vector>

#include "apps/view/window.hpp"
#include "engine/render/panel_pass.hpp"

namespace palpate {

/// Dear ImGui without a window or GPU of its own: receives the window's events and returns the panels' triangles.
class Gui {
 public:
  /// Panels are laid out at the window's scale (Window::scale()), also when that changes, times the size of text.
  explicit Gui(Window& window);
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  /// Coverage of each texel of the font.
  std::span<const std::uint8_t> texture() const { return {texture_, std::size_t{texture_px_.x} * texture_px_.y}; }
  const UVec2& texture_px() const { return texture_px_; }

  /// Returns whether the event is consumed: Escape that closes a list.
  bool feed(const WindowEvent& event);
  /// Notes text that the panels will show; its letters beyond Latin are added to the font at the next frame.
  void noteLetters(std::string_view text);
  /// The panels of one frame are drawn between these.
  void begin(const UVec2& size_px, double dt_s);
  PanelShapes end();
  /// Number of times the font was built.
  std::uint64_t fontVersion() const { return fontVersion_; }

  /// Whether the mouse, or the keys, are meant for a panel and not for the model behind it.
  bool wantsMouse() const;
  bool wantsKeys() const;
  /// Whether a value is being dragged or typed.
  bool isBusy() const;
  double scale() const { return scale_; }
  bool isDark() const { return dark_; }
  /// Theme and size of text from the next frame on.
  void setLook(bool dark, int text_percent);

 private:
  void gather();
  void makeFont();
  void applyLook();

  Window& window_;
  double scale_ = 0;
  bool dark_ = true;
  int text_percent_ = 100;
  std::uint8_t* texture_ = nullptr;
  UVec2 texture_px_{0};
  std::uint64_t fontVersion_ = 0;
  std::set<unsigned> letters_{U'\u2026'};  // beyond Latin
  std::vector<unsigned short> ranges_;
  bool lacksLetters_ = false, closesList_ = false;
  std::string clipboard_;
  std::vector<shared::PanelVertex> vertices_;
  std::vector<shared::PanelTriangle> triangles_;
  std::vector<Vec4> clips_;
};

}  // namespace palpate
