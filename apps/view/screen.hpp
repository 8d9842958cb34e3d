// Composes the model's picture and the panels over it, and shows the result on the display or writes it to a file.
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

  /// Sets the size of the window, and whether to wait for the display (vsync).
  void fit(const UVec2& window_px, bool waitsForDisplay);
  /// Zero on a side while the window is not visible.
  const UVec2& size_px() const { return presenter_->size_px(); }
  bool isVisible() const { return size_px().x > 0 && size_px().y > 0; }
  const Device& sight() const { return sight_; }

  struct Layers {
    std::function<void(CommandList&)> drawModel;  ///< empty: no model
    bool modelDiffers = false;                    ///< from the last picture shown
    const ModelPicture* model = nullptr;          ///< target of drawModel
    PanelShapes panels;
    bool dark = true;    ///< background without a model
    int servoCore = -1;  ///< core that a software driver avoids; negative: no servo thread runs
  };
  /// Only while isVisible(). False, with nothing drawn, if the picture would be the one that is shown already.
  bool show(const Layers& layers);
  /// The next picture is shown in any case.
  void forget() { content_.reset(); }
  /// Whether the display accepted the last picture; otherwise it was not drawn.
  bool wasShown() const { return wasShown_; }
  /// Waits until the GPU has finished the last picture.
  void waitForLast() { presenter_->waitForLast(); }
  /// Command list of the last picture, with its passes.
  const CommandList& list() const { return list_; }

  /// Writes the next picture to a file.
  void keep(const std::string& file) { kept_ = file; }
  bool isKeeping() const { return kept_.has_value(); }
  /// Writes the picture requested by keep().
  void writeKept(Messages& messages);

 private:
  std::uint64_t contentOf(const Layers& layers) const;
  void write(const std::string& file);

  Device& sight_;
  const Gui& gui_;
  std::uint64_t fontVersion_;  // of the panels' present texture
  PanelPass panelPass_;
  std::unique_ptr<Presenter> presenter_;
  CommandList list_;
  Buffer shown_;
  UVec2 shown_px_{0};
  bool wasShown_ = true;
  std::optional<std::uint64_t> content_;  // checksum of what is shown, apart from the model
  std::optional<std::string> kept_;
};

}  // namespace palpate
