// PCD, the format of the Point Cloud Library.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat pcdFormat();

}  // namespace palpate
