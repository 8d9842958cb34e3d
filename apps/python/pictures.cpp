// Pictures and meshes of a session in Python.
#include "apps/python/session.hpp"

namespace palpate::python {

namespace {

using Vector = std::array<double, 3>;
using Color = std::array<std::uint8_t, 3>;

void give(const std::optional<Vector>& given, std::uint32_t& has, double (&to)[3]) {
  has = given ? 1 : 0;
  for (std::size_t k = 0; given && k < 3; ++k) to[k] = (*given)[k];
}

}  // namespace

void bindSessionsPictures(py::class_<PySession>& session) {
  session
      .def(
          "render",
          [](PySession& self, const std::pair<std::uint32_t, std::uint32_t>& size, const std::optional<Vector>& eye,
             const std::optional<Vector>& target, const std::optional<Vector>& up, double fov, const std::string& color,
             const std::optional<Color>& background, std::uint32_t samples, const std::string& colorMap,
             const std::string& colorRange, const std::string& material, const std::string& occlusion,
             const std::string& cavity, const std::string& ground, const std::string& eyeDome,
             const std::string& projection, double orthoHeight, bool transparent, const std::string& splats,
             const std::string& backs, const std::string& side) {
            pp_picture_options options = pp_default_picture_options();
            options.width = size.first;
            options.height = size.second;
            options.samples = samples;
            options.fov_deg = fov;
            options.color = color.c_str();
            options.color_map = colorMap.c_str();
            options.color_range = colorRange.c_str();
            options.material = material.c_str();
            options.occlusion = occlusion.c_str();
            options.cavity = cavity.c_str();
            options.ground = ground.c_str();
            options.eye_dome = eyeDome.c_str();
            options.projection = projection.c_str();
            options.ortho_height = orthoHeight;
            options.transparent = transparent ? 1 : 0;
            options.splats = splats.c_str();
            options.backs = backs.c_str();
            options.side = side.c_str();
            give(eye, options.has_eye, options.eye);
            give(target, options.has_target, options.target);
            give(up, options.has_up, options.up);
            options.has_background = background ? 1 : 0;
            for (std::size_t k = 0; background && k < 3; ++k) options.background[k] = (*background)[k];
            return self.render(size, options);
          },
          py::arg("size") = std::pair(1280, 720), py::arg("eye") = py::none(), py::arg("target") = py::none(),
          py::arg("up") = py::none(), py::arg("fov") = 45.0, py::arg("color") = "rgb",
          py::arg("background") = py::none(), py::arg("samples") = 4, py::arg("color_map") = "auto",
          py::arg("color_range") = "auto", py::arg("material") = "auto", py::arg("occlusion") = "auto",
          py::arg("cavity") = "auto", py::arg("ground") = "auto", py::arg("eye_dome") = "auto",
          py::arg("projection") = "perspective", py::arg("ortho_height") = 0.0, py::arg("transparent") = false,
          py::arg("splats") = "auto", py::arg("backs") = "auto", py::arg("side") = "auto",
          "render(size=(1280, 720), eye=None, target=None, up=None, fov=45, color='rgb', background=None, "
          "samples=4, color_map='auto', color_range='auto', material='auto', occlusion='auto', cavity='auto', "
          "ground='auto', eye_dome='auto', projection='perspective', ortho_height=0, transparent=False, "
          "splats='auto', backs='auto', side='auto')\n\n"
          "Draws the present points: uint8, height x width x 4, rows from the top. size: width, height,\n"
          "16384 at most. eye, target, up: model units; what is not given is chosen to fit the model. fov:\n"
          "vertical, degrees. color: rgb, material, normal, depth, height, or a field. background: three of\n"
          "0 to 255. samples: per pixel, 1 or 4. color_map: viridis, turbo, grey, red-blue, classes, terrain, or auto\n"
          "(classes for the field classification, terrain for height and depth, else viridis). color_range: "
          "'LOW,HIGH', numbers or percentiles as 2%, of a\n"
          "field; auto: 2%,98%, and of classes all. material: clay, stone, plaster, metal, unlit, water (of particles\n"
          "that fill a volume), or auto (water for a scene of it, unlit for a file with colours and without normals,\n"
          "else clay). occlusion, cavity, ground, eye_dome: on, off, or auto\n"
          "(as palpate render). projection: perspective, orthographic, or isometric (orthographic, from the front,\n"
          "the right and above). ortho_height: of an orthographic picture, model units; 0: so that the model fills\n"
          "it. transparent: without a background; the fourth number of a pixel is its opacity.\n"
          "splats, of a splat scene: gaussians (as it was trained), surface (the points that are felt), or auto\n"
          "(gaussians). backs, of surfaces seen from there: shown, hidden, or auto (hidden in a room that was\n"
          "scanned from inside). side, from which the model is seen, unless eye is given: front, back, left, right,\n"
          "top, bottom, isometric (which is orthographic), or auto (from the front, slightly above).")
      .def(
          "mesh",
          [](PySession& self, std::uint32_t resolution, const std::string& surface, std::optional<double> radius_mm) {
            pp_mesh_options options = pp_default_mesh_options();
            options.resolution = resolution;
            options.surface = surface.c_str();
            options.radius_mm = radius_mm.value_or(0);
            return std::make_shared<PyMesh>(self.with([&](pp::Session& open) { return open.mesh(options); }));
          },
          py::arg("resolution") = 128, py::arg("surface") = "sphere", py::arg("radius_mm") = py::none(),
          "mesh(resolution=128, surface='sphere', radius_mm=None) -> Mesh\n\n"
          "Meshes the present points by marching cubes. resolution: cells along the longest side, 1 to 2048.\n"
          "surface: sphere, average, sharp or density. radius_mm: support radius; None: from the spacing of\n"
          "the points.");
}

}  // namespace palpate::python
