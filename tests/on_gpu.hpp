// Which back end a test program runs the cases of files on that two programs share (tests/rooms.cmake).
#pragma once

namespace palpate {

extern const bool kOnGpu;
/// A number that depends on the back end.
template <class T>
T onCpuOrGpu(T cpu, T gpu) {
  return kOnGpu ? gpu : cpu;
}

}  // namespace palpate
