// The formats, each in a file of its own, with the functions that its table (cloud_formats.cpp) calls.
#pragma once

#include "engine/io/cloud_format.hpp"

namespace palpate {

CloudFormat plyFormat();

/// Points as lines of text, which all scanning programs can write.
/// A point per line: numbers separated by blanks, tabs, commas or semicolons (TextWords); lines that begin with `#` or
/// `//` are comments. A line before the first point may name the columns like PLY properties: x y z, nx ny nz, red
/// green blue (or r g b), case-insensitive and with the names of surveyors and spreadsheets; any other columns are kept
/// as attributes, or named as lost if they contain words. Up to 20 title lines may precede it. Without names, columns
/// behind x y z are determined by all rows (UnnamedColumns), and reported as assumed (StoredCloud::assumed). Writing
/// adds the line of names if there are other columns than positions.
CloudFormat xyzFormat();
/// The same with commas, and always with names; any separator is accepted when reading.
CloudFormat csvFormat();
/// Each scan is preceded by its number of points; columns are x y z, an intensity, red green blue.
CloudFormat ptsFormat();

/// PTX, Leica's text format of structured scans (Cyclone, "PTX format"): grid, pose and points of each scan.
/// A scan has its numbers of columns and rows, its scanner's position and axes, a matrix of four rows, the last one of
/// which is the translation, and a line for each point: x y z, an intensity, and optionally red green blue. (0 0 0)
/// means no echo: such points are left out and counted. All scans become one cloud, transformed by their matrices. Read
/// only.
CloudFormat ptxFormat();

/// LAS 1.0 to 1.4, the format of laser scanners, and its compressed forms: LAZ, and COPC, which is LAZ in an octree.
CloudFormat lasFormat();
CloudFormat lazFormat();
/// Read only.
CloudFormat copcFormat();

/// E57 (ASTM E2807), scans of terrestrial laser scanners. Read only.
CloudFormat e57Format();

/// PCD, the format of the Point Cloud Library.
CloudFormat pcdFormat();

/// NumPy arrays: NPY, one array, and NPZ, several named arrays.
CloudFormat npyFormat();
CloudFormat npzFormat();

/// The points of a COLMAP model. Read only. Normals come from normalsFromViews(), with weights from the tracks and
/// errors of points; `error` (pixels) and `track_length` of each point are kept as attributes. The orientation of the
/// cameras determines the up axis, if they agree on one.
CloudFormat colmapFormat();

/// The points of a dense COLMAP reconstruction: a PLY file with NAME.ply.vis beside it, both written by COLMAP's stereo
/// fusion. It is read as PLY; its normals are oriented towards the images that saw their points, or computed by
/// normalsFromViews() if missing. The images are those of the model in the folder `sparse` beside it, or in its own
/// folder; without a model this is logged, and the file is read as plain PLY. Never written; a file that palpate saved
/// under such a name is plain PLY with other points.
CloudFormat colmapDenseFormat();

/// Scenes of 3D Gaussians: PLY files whose points have `scale_0` and `rot_0`. Reading gives the Gaussians' surface
/// (surfaceOf()), with normals and colours; a pipe cannot be recognised, and is read as plain PLY. Writing converts
/// points to Gaussians (gaussian_writer.hpp).
CloudFormat gaussianFormat();

/// Gaussian splats packed for the web: SuperSplat's compressed PLY (PlayCanvas 2023, "Compressing Gaussian splats"),
/// antimatter15's .splat (2023) and Niantic's SPZ, versions 2 and 3 (2024, the README of nianticlabs/spz).
/// All three are read only. As with gaussianFormat(), the cloud is the Gaussians' surface.
CloudFormat compressedPlyFormat();
CloudFormat splatFormat();
CloudFormat spzFormat();

/// Triangle meshes: reading samples points from them; the first three can be written if there are triangles.
CloudFormat objFormat();
CloudFormat stlFormat();
CloudFormat offFormat();
CloudFormat gltfFormat();  ///< read only; GLB as well

/// Default number of points sampled from a mesh.
inline constexpr std::size_t kUsualSamples = 500'000;

}  // namespace palpate
