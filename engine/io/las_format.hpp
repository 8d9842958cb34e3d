// LAS 1.0 to 1.4, the format of laser scanners, and its compressed forms: LAZ, and COPC, which is LAZ in an octree.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat lasFormat();
CloudFormat lazFormat();
/// Read only.
CloudFormat copcFormat();

}  // namespace palpate
