#pragma once

#include <memory>
#include <string_view>

#include "apps/view/window.hpp"
#include "engine/gpu/presenter.hpp"

namespace palpate {

/// Whether a window takes pictures that are copied to it through the host's memory: one on a display of X does.
bool takesCopies(const Window& window);

/// The presenter that copies. Throws Error where the window takes no copies.
std::unique_ptr<Presenter> copyingPresenter(const Window& window, Device& device, bool waitsForDisplay);

/// Why NVIDIA's driver must not even be asked whether it presents to a window; empty where it may.
std::string_view whyNotAskNvidia(const Window& window);

}  // namespace palpate
