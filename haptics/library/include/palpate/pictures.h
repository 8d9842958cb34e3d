/** @file
 * palpate's C interface: pictures and meshes of the points of a session. palpate.h includes this. */
#ifndef PALPATE_PICTURES_H
#define PALPATE_PICTURES_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup pictures Pictures and meshes
 * @{ */

/** Largest width and height of a picture, pixels. */
#define PP_MAX_PICTURE_SIDE 16384

/** Camera and colours of a picture. */
typedef struct pp_picture_options {
  uint32_t size;           /**< bytes of this struct */
  uint32_t width;          /**< pixels, 1 to PP_MAX_PICTURE_SIDE */
  uint32_t height;         /**< pixels, 1 to PP_MAX_PICTURE_SIDE */
  uint32_t samples;        /**< samples per pixel: 1 or 4 */
  uint32_t has_eye;        /**< 1: `eye` is used; 0: chosen to fit the model */
  uint32_t has_target;     /**< 1: `target` is used; 0: chosen to fit the model */
  uint32_t has_up;         /**< 1: `up` is used; 0: chosen to fit the model */
  uint32_t has_background; /**< 1: `background` is used; 0: the default */
  double eye[3];           /**< position of the camera, model units */
  double target[3];        /**< position that it looks at, model units */
  double up[3];            /**< direction that is up in the picture, of any length but 0 */
  double fov_deg;          /**< vertical field of view, degrees, 1 to 170 */
  const char* color;       /**< "rgb", "material", "normal", "depth", "height", or a field of the points; null: rgb */
  uint8_t background[4];   /**< red green blue; the fourth is not used */
  uint32_t transparent;    /**< 1: without a background; the fourth byte of a pixel is its opacity */
  /** Colours of depths, heights and fields: "viridis", "turbo", "grey", "red-blue", "classes" (of LAS, of a field),
   * "terrain"; null or "auto": classes for the field classification, terrain for heights and depths, else viridis */
  const char* color_map;
  /** "LOW,HIGH" of a field: the numbers at the ends of the colours, or percentiles as 2%,98%; null or "auto": those
   * percentiles, and of classes all */
  const char* color_range;
  const char* material;   /**< "clay", "stone", "plaster", "metal", "unlit", "water" (of particles that fill a volume);
                             null or "auto": water for a scene of it, unlit for a file with colours and without normals,
                             else clay */
  const char* occlusion;  /**< hollows are darker: "on", "off"; null or "auto": off on software drivers */
  const char* cavity;     /**< grooves are darker: likewise */
  const char* ground;     /**< shadow on a ground below the model, which is not felt: likewise */
  const char* eye_dome;   /**< outlines of depth: "on", "off"; null or "auto": on if auto makes the material unlit */
  const char* projection; /**< "perspective", "orthographic", or "isometric" (orthographic, from the front, the right
                             and above); null: perspective */
  double ortho_height;    /**< of an orthographic picture, model units; 0: so that the model fills it */
  /** How a splat scene is drawn: "gaussians" as it was trained, "surface" as the points that are felt; null or "auto":
   * gaussians. Other colours than rgb are always of the points */
  const char* splats;
  /** Surfaces seen from their back: "shown", "hidden"; null or "auto": hidden in a room that was scanned from inside */
  const char* backs;
  /** Side from which the model is seen, unless `eye` is used: "front", "back", "left", "right", "top", "bottom", or
   * "isometric" (which is orthographic); null or "auto": from the front, slightly above */
  const char* side;
} pp_picture_options;
PP_OPTIONS(picture_options)
/** Draws the present points into `rgba`: rows from the top, 4 bytes for each pixel; `bytes` is the size of the buffer.
 * Uses the GPU that answers; a session on the CPU uses the best GPU available. Options may be null. PP_ERROR_ARGUMENT
 * if the picture is too large or the buffer too small, PP_ERROR_GPU if there is no GPU, PP_ERROR_UNSUPPORTED if palpate
 * was built without Vulkan. */
PP_API pp_status pp_session_render(pp_session session, const pp_picture_options* options, uint8_t* rgba,
                                   uint64_t bytes);
/** Writes such a picture as .png or .jpg. PP_ERROR_FILE if it cannot be written, PP_ERROR_UNSUPPORTED if palpate was
 * built without Vulkan. */
PP_API pp_status pp_image_write(const char* file, const uint8_t* rgba, uint32_t width, uint32_t height);

/** Handle of a mesh. Any number of threads may use it. */
typedef struct pp_mesh {
  uint64_t id; /**< 0 is null */
} pp_mesh;

/** How pp_session_mesh() meshes the points. */
typedef struct pp_mesh_options {
  uint32_t size;       /**< bytes of this struct */
  uint32_t resolution; /**< cells along the longest side, 1 to 2048 */
  const char* surface; /**< "sphere", "average", "sharp" or "density"; null: sphere */
  double radius_mm;    /**< support radius, mm; 0: from the spacing of the points */
} pp_mesh_options;
PP_OPTIONS(mesh_options)
/** Meshes the present points by marching cubes, on the GPU that pp_session_render() uses. Options may be null.
 * PP_ERROR_FAILED if the points show no surface: they are farther apart than the support radius. PP_ERROR_GPU
 * and PP_ERROR_UNSUPPORTED as for pp_session_render(). */
PP_API pp_status pp_session_mesh(pp_session session, const pp_mesh_options* options, pp_mesh* mesh);

/** View of a mesh. */
typedef struct pp_triangles {
  pp_points vertices;        /**< with normals */
  uint64_t count;            /**< triangles */
  const uint32_t* triangles; /**< 3 indices of vertices for each, anticlockwise as seen from outside */
  uint32_t closed;           /**< 1: the mesh has no border */
  uint32_t reserved;         /**< not used */
} pp_triangles;
/** Read-only view of the mesh; nothing is copied. Valid until the mesh is closed. */
PP_API pp_status pp_mesh_view(pp_mesh mesh, pp_triangles* triangles);
/** Writes vertices with normals and triangles in the format of the file's extension, as pp_cloud_write() does. */
PP_API pp_status pp_mesh_write(pp_mesh mesh, const char* file, const pp_write_options* options);
/** Closes the handle and invalidates its views. */
PP_API pp_status pp_mesh_close(pp_mesh mesh);

/** @} */

#endif
