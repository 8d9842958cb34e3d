#pragma once

namespace palpate {

/// Whether stderr is a console that understands control sequences ("\033[K").
bool isErrorConsole() noexcept;

}  // namespace palpate
