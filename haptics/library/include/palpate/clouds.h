/** @file
 * palpate's C interface: clouds, read from files or made from arrays. palpate.h includes this. */
#ifndef PALPATE_CLOUDS_H
#define PALPATE_CLOUDS_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup clouds Clouds: points with normals and colours, immutable
 * @{ */

/** Handle of a cloud. Any number of threads may use it. */
typedef struct pp_cloud {
  uint64_t id; /**< 0 is null */
} pp_cloud;

/** Type of the numbers of an array. */
typedef enum pp_number {
  PP_FLOAT32 = 0, /**< float */
  PP_FLOAT64 = 1, /**< double */
  PP_UINT8 = 2,   /**< uint8_t */
  PP_UINT16 = 3   /**< uint16_t */
} pp_number;

/** An array of the program with one row for each point. */
typedef struct pp_rows {
  const void* data; /**< null: not given */
  int32_t type;     /**< pp_number */
  int32_t reserved; /**< 0 */
  int64_t stride;   /**< bytes from one row to the next; 0: rows are contiguous */
} pp_rows;

/** Arrays of the program from which a cloud is made. */
typedef struct pp_cloud_arrays {
  uint32_t size;     /**< bytes of this struct */
  uint32_t reserved; /**< not used */
  uint64_t count;    /**< points */
  pp_rows positions; /**< x y z, PP_FLOAT32 or PP_FLOAT64; doubles keep their precision */
  pp_rows normals;   /**< PP_FLOAT32 or PP_FLOAT64; are normalized */
  pp_rows colors; /**< red green blue: PP_UINT8 0 to 255, PP_UINT16 0 to 65535, PP_FLOAT32 and PP_FLOAT64 0 to 1, or 0
                     to 255 if any is above 1; other values are refused */
} pp_cloud_arrays;
PP_OPTIONS(cloud_arrays)
/** Creates a cloud from arrays, which are copied. PP_ERROR_ARGUMENT names the first row with an invalid number. Zero
 * normals are replaced by that of the nearest point that has one; PP_ERROR_ARGUMENT if more than a tenth are zero. */
PP_API pp_status pp_cloud_create(const pp_cloud_arrays* arrays, pp_cloud* cloud);

/** How pp_cloud_read() reads a file. */
typedef struct pp_read_options {
  uint32_t size;               /**< bytes of this struct */
  uint32_t keep_unreliable;    /**< 1: includes points of a reconstruction that its own measures mark as unreliable */
  uint32_t normals_from_faces; /**< 1: area-weighted normals of the faces replace those of the file */
  uint32_t reserved;           /**< not used */
  pp_log_function log;         /**< receives what of the file is not kept; null: none */
  void* log_user;              /**< passed to `log` */
  pp_watch watch;              /**< watches this call */
} pp_read_options;
PP_OPTIONS(read_options)
/** Reads a cloud of any format in pp_formats_read(), recognized by the content of the file or by its extension. Options
 * may be null. PP_ERROR_FILE, with the line or byte, if it cannot be read. */
PP_API pp_status pp_cloud_read(const char* file, const pp_read_options* options, pp_cloud* cloud);

/** How a cloud or a mesh is written. */
typedef struct pp_write_options {
  uint32_t size;     /**< bytes of this struct */
  uint32_t ascii;    /**< 1: text, if the format has both: shortest decimals that read back as the same number */
  uint32_t backup;   /**< 1: an existing file is kept as NAME.EXT.bak; 0: it is replaced */
  uint32_t reserved; /**< not used */
  pp_watch watch;    /**< watches this call */
} pp_write_options;
PP_OPTIONS(write_options)
/** Writes a cloud in the format of the file's extension, one of pp_formats_written(). The file appears under its name
 * only when it is complete. What the format cannot hold is not written: text without names (.pts) has positions,
 * colours and intensity alone; `palpate convert` names what is lost. The points of a splat scene are the surface of its
 * Gaussians, which PLY has in their place: those that were not changed bit by bit. Options may be null. PP_ERROR_FILE
 * if it cannot be written. */
PP_API pp_status pp_cloud_write(pp_cloud cloud, const char* file, const pp_write_options* options);
/** Extensions of files, and kinds of folders, that can be read: ".ply, .las, …" */
PP_API const char* pp_formats_read(void);
/** Extensions of files that can be written: ".ply, .las, …" Only meshes can be written as .obj, .stl and .off. */
PP_API const char* pp_formats_written(void);

/** Read-only view of the points in memory; nothing is copied. Valid until the cloud is closed. */
typedef struct pp_points {
  uint64_t count;         /**< number of points */
  double origin[3];       /**< file coordinates = origin + position; zero if float32 alone is precise enough */
  const float* positions; /**< 3 for each point, relative to origin */
  const float* normals;   /**< 3 for each point, unit length; null: no normals */
  const uint8_t* colors;  /**< red green blue alpha of each point, 0 to 255; null: no colours */
  double min[3];          /**< minimum corner of the bounding box, file coordinates; 0 without points */
  double max[3];          /**< maximum corner of the bounding box, file coordinates; 0 without points */
} pp_points;
/** Views the points of a cloud. */
PP_API pp_status pp_cloud_view(pp_cloud cloud, pp_points* points);
/** Copies the positions in file coordinates, with all known precision: 3 for each point. `count` must be the number of
 * points, or else the call returns PP_ERROR_ARGUMENT. */
PP_API pp_status pp_cloud_copy_positions(pp_cloud cloud, double* positions, uint64_t count);

/** A further number for each point of the file, such as an intensity; it is preserved when the cloud is written. */
typedef struct pp_attribute {
  const char* name; /**< as in the file */
  const char* type; /**< int8 uint8 int16 uint16 int32 uint32 float32 float64 int64 uint64 */
  const void* data; /**< one for each point; valid until the cloud is closed, as the name is */
} pp_attribute;
/** Number of such attributes of a cloud. */
PP_API pp_status pp_cloud_attribute_count(pp_cloud cloud, uint64_t* count);
/** One of the attributes, by its index from 0. PP_ERROR_ARGUMENT if the index is out of range. */
PP_API pp_status pp_cloud_get_attribute(pp_cloud cloud, uint64_t index, pp_attribute* attribute);

/** How pp_cloud_prepare() and pp_cloud_compute() treat a cloud. */
typedef struct pp_prepare_options {
  uint32_t size;      /**< bytes of this struct */
  uint32_t reserved;  /**< not used */
  const char* steps;  /**< JSON object of settings of the section `prepare`, as {"where": "z > 3", "random": 90}; the
                         reference page lists them, and their order; null: none */
  const char* up;     /**< up axis, as "z" or "-y", for heights and for the level; null: found from the shape */
  double mm_per_unit; /**< of lengths in mm; 0: as the file states, or the longest side is 100 mm */
  pp_watch watch;     /**< watches this call */
} pp_prepare_options;
PP_OPTIONS(prepare_options)
/** Selects and cleans the points of a cloud, and sets fields. `kept`: receives 1 for each of the `count` points of the
 * cloud that stay, else 0; null: not wanted. `result`: receives them as a cloud, which may be empty; null: not wanted.
 * Points keep all that no step sets, bit by bit. The result of a splat scene is made by doing the steps to its
 * Gaussians, whose columns are fields; `kept` by doing them to the points. New points, which close holes, follow all
 * others and are not in `kept`. PP_ERROR_ARGUMENT for invalid settings and expressions, with the column. */
PP_API pp_status pp_cloud_prepare(pp_cloud cloud, const pp_prepare_options* options, uint8_t* kept, uint64_t count,
                                  pp_cloud* result);
/** The points of a cloud whose entry in `mask` is not 0, with all that they have. `count` must be the number of points
 * of the cloud. */
PP_API pp_status pp_cloud_choose(pp_cloud cloud, const uint8_t* mask, uint64_t count, pp_cloud* result);
/** Computes a number for each point, as "z", "intensity / 256" or "density". `count` must be the number of points.
 * Options may be null; their steps are not used. PP_ERROR_ARGUMENT for an invalid expression, with the column. */
PP_API pp_status pp_cloud_compute(pp_cloud cloud, const char* number, const pp_prepare_options* options, double* values,
                                  uint64_t count);
/** Closes the handle and invalidates its views; sessions of the cloud are not affected. */
PP_API pp_status pp_cloud_close(pp_cloud cloud);

/** @} */

#endif
