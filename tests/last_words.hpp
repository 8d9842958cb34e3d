// What a test program says when it is ended by a fault of its own, or by the clock: in which case it stood, and where
// in it.
#pragma once

namespace palpate {

/// From now on, of the process that calls this, and not of those that it begins. Where the system has no way of its
/// own, the test framework's stays.
void sayLastWords();

}  // namespace palpate
