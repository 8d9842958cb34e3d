#pragma once

#include <memory>
#include <string_view>

#include "apps/view/window.hpp"
#include "engine/gpu/presenter.hpp"

namespace palpate {

/// Whether pictures can be copied to the window through the host's memory: true on an X display.
bool takesCopies(const Window& window);

/// Makes a presenter that copies. Throws Error where takesCopies() is false.
std::unique_ptr<Presenter> copyingPresenter(const Window& window, Device& device, bool waitsForDisplay);

/// Why NVIDIA's driver must not be queried for presentation support (it may crash); empty where it may be queried.
std::string_view whyNotAskNvidia(const Window& window);

}  // namespace palpate
