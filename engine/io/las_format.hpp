// LAS 1.0 to 1.4, the files of laser scanners, as a format, and packed: LAZ, and COPC, which is LAZ by the nodes of an
// octree.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat lasFormat();
CloudFormat lazFormat();
/// Is only read.
CloudFormat copcFormat();

}  // namespace palpate
