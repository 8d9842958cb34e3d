// Report of a test program that crashes or exceeds its time limit: the current case, and the position in it.
#pragma once

namespace palpate {

/// Installs the report for this process, but not for its children. On systems without an implementation the test
/// framework's handler stays.
void sayLastWords();

}  // namespace palpate
