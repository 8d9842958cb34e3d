// The back end of this test program: the CPU in tests_matter, the GPU in tests_matter_gpu, which run the cases of the
// same files (matter_truths in tests/rooms.cmake). A number that depends on the back end is onCpuOrGpu(one, other).
#pragma once

#include "tests/labels.hpp"
#include "tests/matter/soft_maker.hpp"
#include "tests/on_gpu.hpp"

namespace palpate {

/// A label of the case on a GPU alone.
struct LabelOnGpu {
  CaseLabel label;
  void fill(doctest::detail::TestCase& labelled) const {
    if (kOnGpu) label.fill(labelled);
  }
};
inline constexpr LabelOnGpu kFullOnGpu{kFull};

/// Fixtures of a case that runs on each back end. On a GPU a validation message fails the case.
class OnMatter {
 public:
  ~OnMatter();

 protected:
  static MatterMaker maker(unsigned threads);  // of the CPU
  const MatterMaker make = maker(2);
};
class OnSoft {
 public:
  ~OnSoft();

 protected:
  static SoftMaker maker(unsigned threads);
  const SoftMaker make = maker(2);
  const SoftBend bend = bender();

 private:
  static SoftBend bender();
};

}  // namespace palpate
