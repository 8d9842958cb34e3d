#include "tests/matter/on_matter.hpp"

namespace palpate {

const bool kOnGpu = false;

OnMatter::~OnMatter() = default;
MatterMaker OnMatter::maker(unsigned threads) { return onCpu(threads); }

OnSoft::~OnSoft() = default;
SoftMaker OnSoft::maker(unsigned threads) { return softOnCpu(threads); }
SoftBend OnSoft::bender() { return bendOnCpu(); }

}  // namespace palpate
