// What the window shows: the model's picture and the panels over it, on their way to the display or to a file.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "apps/view/presentation.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/render/panel_pass.hpp"

namespace palpate {

class Gui;
class Messages;
class ModelPicture;

class Screen {
 public:
  Screen(Window& window, Device& sight, const Gui& gui, std::optional<Presentation> presentation);

  /// As large as the window, and at the display's pace or not.
  void fit(const UVec2& window_px, bool waitsForDisplay);
  /// Zero on a side while there is nothing to be seen.
  const UVec2& size_px() const { return presenter_->size_px(); }
  bool isVisible() const { return size_px().x > 0 && size_px().y > 0; }
  const Device& sight() const { return sight_; }

  struct Layers {
    std::function<void(CommandList&)> drawModel;  ///< empty: there is none
    const ModelPicture* model = nullptr;          ///< that it draws into
    PanelShapes panels;
    PanelShapes behindPanels;  ///< of them what belongs to a picture of the model, too: scale and heights
    bool dark = true;          ///< where no model is
    int servoCore = -1;        ///< which a software driver keeps off; negative: nothing is served
  };
  /// While it is visible.
  void show(const Layers& layers);
  /// Whether the display had time for the last picture; it is not drawn, otherwise.
  bool wasShown() const { return wasShown_; }
  /// The GPU has done what the last picture asked of it.
  void waitForLast() { presenter_->waitForLast(); }
  /// Its passes.
  const CommandList& list() const { return list_; }

  /// What a picture is of: all that the window shows, or the model, without panels.
  enum class Of { window, model };
  /// The next picture is written to a file; of one of the model it is said.
  void keep(const std::string& file, Of of) { kept_ = Kept{file, of}; }
  /// `layers`: of that picture.
  void writeKept(const Layers& layers, Messages& messages);

 private:
  struct Kept {
    std::string file;
    Of of = Of::window;
  };
  void compose(CommandList& list, const Layers& layers, const PanelShapes& panels, const Buffer& into);
  void write(const Kept& kept, const Layers& layers);

  Device& sight_;
  const Gui& gui_;
  std::uint64_t fontVersion_;  // that the panels are drawn with
  PanelPass panelPass_;
  std::unique_ptr<Presenter> presenter_;
  CommandList list_;
  Buffer shown_;
  UVec2 shown_px_{0};
  bool wasShown_ = true;
  std::optional<Kept> kept_;
};

}  // namespace palpate
