#pragma once

namespace palpate {

/// Whether a person reads stderr on a console that understands control sequences ("\033[K").
bool isErrorConsole() noexcept;

}  // namespace palpate
