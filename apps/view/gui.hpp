#pragma once

#include <set>
#include <span>
#include <string_view>
#include <vector>

#include "apps/view/window.hpp"
#include "engine/render/panel_pass.hpp"

namespace palpate {

/// Dear ImGui without a window or a GPU of its own: takes the window's events, gives the triangles of its panels.
class Gui {
 public:
  /// `scale`: pixels for each unit that panels are laid out in.
  explicit Gui(Window& window);
  ~Gui();
  Gui(const Gui&) = delete;
  Gui& operator=(const Gui&) = delete;

  /// How much of each texel of the font is covered.
  std::span<const std::uint8_t> texture() const { return {texture_, std::size_t{texture_px_.x} * texture_px_.y}; }
  const UVec2& texture_px() const { return texture_px_; }

  /// Whether that was all: Escape has closed a list.
  bool feed(const WindowEvent& event);
  /// What the panels are to show; letters beyond Latin come into the font with the next picture.
  void noteLetters(std::string_view text);
  /// Panels of one picture stand between these.
  void begin(const UVec2& size_px, double dt_s);
  PanelShapes end();
  /// Of them what lies behind all panels: scale and heights.
  PanelShapes behindPanels() const;
  /// How often the font has been made.
  std::uint64_t fontVersion() const { return fontVersion_; }

  /// Whether a panel, and not what is behind it, is meant by the mouse, or by keys.
  bool wantsMouse() const;
  bool wantsKeys() const;
  /// While a value is being dragged or typed.
  bool isBusy() const;
  double scale() const { return scale_; }
  void setDark(bool dark);

 private:
  void gather();
  void makeFont();

  Window& window_;
  double scale_;
  std::uint8_t* texture_ = nullptr;
  UVec2 texture_px_{0};
  std::uint64_t fontVersion_ = 0;
  std::set<unsigned> letters_;  // beyond Latin
  std::vector<unsigned short> ranges_;
  bool lacksLetters_ = false, closesList_ = false;
  std::size_t behind_ = 0;  // triangles
  std::string clipboard_;
  std::vector<shared::PanelVertex> vertices_;
  std::vector<shared::PanelTriangle> triangles_;
  std::vector<Vec4> clips_;
};

}  // namespace palpate
