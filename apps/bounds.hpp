// The bounds of what can be asked for on the command line: beyond them a number is a slip of the keyboard, or overflows
// something behind it. An option whose bounds are its own has them beside it.
#pragma once

namespace palpate::bounds {

inline constexpr double kLongest_s = 1e7;  ///< of anything that takes time: more than a hundred days

}  // namespace palpate::bounds
