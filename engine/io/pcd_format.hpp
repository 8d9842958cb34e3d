// PCD, the files of the Point Cloud Library, as a format.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat pcdFormat();

}  // namespace palpate
