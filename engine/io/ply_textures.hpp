// Colours of a PLY file's textures, which its comments name as MeshLab writes them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/texture.hpp"

namespace palpate {

/// The textures of "comment TextureFile NAME", in files beside `file`.
std::vector<Texture> texturesOf(const PlyInfo& info, const std::filesystem::path& file);

/// Gives the points of a cloud without colours those of its textures, at the coordinates that its attributes contain
/// ("s" and "t", "u" and "v", "texture_u" and "texture_v"), or else at `spots`, those of its faces, by point. Returns
/// the textures that are not used, with the reason.
std::vector<std::string> colorByTextures(PointCloud& cloud, std::vector<Texture> textures,
                                         std::vector<TextureSpot> spots);

}  // namespace palpate
