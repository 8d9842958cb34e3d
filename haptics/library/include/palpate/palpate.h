/** @mainpage The C and C++ interface of palpate
 *
 * Feel, see and sculpt point clouds in real time: palpate.h for C, palpate.hpp for C++17.
 *
 * Units: positions in model units (the coordinates of the cloud's file), lengths in the hand in mm, forces in N,
 * stiffness in N/mm, times in s. Axes are right-handed.
 *
 * Errors: every function that can fail returns a pp_status. pp_last_error() describes the last failure of the calling
 * thread; its text is valid until another call of that thread fails. No call throws or ends the program. The outputs
 * of a call that fails are zero, unless its description says otherwise: contacts have no force and are not valid,
 * counts and handles are 0.
 *
 * Handles are small values that may be copied. A handle that is null, closed, or of another kind gives PP_ERROR_HANDLE.
 * The caller closes every handle it opens, in any order: a session keeps what it needs of its cloud.
 *
 * Threads: clouds, meshes, frames and logs are immutable, and any number of threads may use them. On a session, one
 * thread (its servo thread) may call pp_touch(), pp_touch_hands() and pp_touch_lift() while another one calls the
 * functions that look at it: pp_session_apply_edits(), pp_session_render(), pp_session_mesh(), pp_session_nearest(),
 * pp_session_raycast(), pp_session_rows(), pp_session_get_info(), pp_session_frame(), the functions that control matter
 * (pp_session_pause() and those after it in matter.h), pp_session_get_sharing(), pp_session_other_hands(),
 * pp_session_cameras(), pp_session_publish_camera(), pp_live_read_ticks(), pp_live_get_state(). Where budget_us is 0,
 * the first eight and the last two of these conflict with pp_touch(), too. All other calls on a session, and all calls
 * on a pp_matter, need exclusive access. A pp_server may be used by any number of threads. A call that conflicts with
 * one in progress returns PP_ERROR_THREAD and does nothing. In a forked process, the parent's sessions, matter and
 * servers give PP_ERROR_STATE, and closing them there does not affect the parent.
 *
 * Memory comes from the C++ library's operator new and, for large arrays, from the system; on a GPU from Vulkan. There
 * is no allocator hook: it would not reach what drivers and other libraries allocate. What can be relied on: opening,
 * building and meshing allocate in proportion to the points, edits in proportion to the points that they change, and a
 * tick of pp_touch() that edits nothing makes no allocation, which a test counts. What palpate returns is freed by
 * closing its handle alone.
 *
 * Options: a struct that begins with `size` is filled by its pp_default_…() function and then changed. That function is
 * compiled into the program and passes the size that the program knows to pp_init_…(), which a program in another
 * language calls directly. A library newer than the program therefore uses the defaults for fields that the program
 * does not know. */
/** @file
 * The C interface. */
#ifndef PALPATE_H
#define PALPATE_H

#include <stddef.h>
#include <stdint.h>

/** Version of the headers, against which the program is compiled; pp_version() is that of the library. */
#define PALPATE_VERSION_MAJOR 0
#define PALPATE_VERSION_MINOR 1 /**< second number */
#define PALPATE_VERSION_PATCH 0 /**< third number */

#if defined(_WIN32) && defined(PALPATE_BUILDS_LIBRARY)
#define PP_API __declspec(dllexport)
#elif defined(_WIN32)
#define PP_API __declspec(dllimport)
#else
/** Exports a function. */
#define PP_API __attribute__((visibility("default")))
#endif

/** Declares pp_init_NAME() and pp_default_NAME() of the struct pp_NAME, which begins with its size. */
#define PP_OPTIONS(name)                                         \
  PP_API void pp_init_##name(pp_##name* options, uint32_t size); \
  static inline pp_##name pp_default_##name(void) {              \
    pp_##name options;                                           \
    pp_init_##name(&options, (uint32_t)sizeof options);          \
    return options;                                              \
  }

#ifdef __cplusplus
extern "C" {
#endif

/** @defgroup base Versions, errors, messages
 * @{ */

/** Result of a call. */
typedef enum pp_status {
  PP_OK = 0,                /**< success */
  PP_ERROR_ARGUMENT = 1,    /**< an argument is null, out of bounds, of the wrong size, or conflicts with another one */
  PP_ERROR_HANDLE = 2,      /**< the handle is null, closed, or of another kind */
  PP_ERROR_THREAD = 3,      /**< another thread is in a call that conflicts with this one */
  PP_ERROR_STATE = 4,       /**< not possible in the present state, such as while the session is live */
  PP_ERROR_FILE = 5,        /**< a file cannot be read or written; see pp_last_error_file() */
  PP_ERROR_GPU = 6,         /**< no GPU, a required feature is missing, or the GPU is lost */
  PP_ERROR_MEMORY = 7,      /**< the host is out of memory */
  PP_ERROR_DEVICE = 8,      /**< the haptic device failed */
  PP_ERROR_UNSUPPORTED = 9, /**< this build of palpate does not include it */
  PP_ERROR_FAILED = 10,     /**< any other failure; pp_last_error() says what failed and what to do */
  PP_ERROR_BUG = 11, /**< a bug of palpate: close the handles in question, and report the text of pp_last_error() */
  PP_ERROR_SIMULATION = 12, /**< matter has diverged, or is too dense to be simulated; reset it to continue */
  PP_ERROR_NETWORK = 13,    /**< no such session is served, its server is gone, or the network cannot be used */
  PP_ERROR_STOPPED = 14     /**< a pp_watch function stopped the call; what was done until then is complete */
} pp_status;

/** Version of the library at run time, such as "0.1.0". */
PP_API const char* pp_version(void);
/** Name of a status, such as "argument" or "file"; "unknown" for any other number. */
PP_API const char* pp_status_name(int status);

/** Status of the last failed call of this thread; PP_OK before the first. */
PP_API pp_status pp_last_status(void);
/** Description of the last failed call of this thread: what is wrong, where, and what to do; empty before the first.
 * The text is this thread's own: it is valid until the next call of this thread that fails, or until the thread ends.
 * Neither its calls that succeed nor any calls of other threads change it. */
PP_API const char* pp_last_error(void);
/** File that the last failure is about; empty if none. Valid as long as pp_last_error(). */
PP_API const char* pp_last_error_file(void);
/** Line of that file, from 1; 0 if unknown. */
PP_API uint64_t pp_last_error_line(void);

/** Weight of a message. What makes a call fail is no message, but its status and pp_last_error(). */
typedef enum pp_log_level {
  PP_LOG_NOTE = 0,   /**< what palpate does or has found, such as that normals are estimated */
  PP_LOG_WARNING = 1 /**< points, frames, strokes or parts of a file are lost, or may be */
} pp_log_level;

/** Receives messages, one line each, without the newline. `level`: a pp_log_level. Called on any thread of the call,
 * session or server that it was given to, except on a servo thread, until that ends: on the calling thread while a call
 * runs, and on threads of palpate for devices and the network. One call at a time for each object. Calls on sessions,
 * matter and servers from within it give PP_ERROR_STATE. Without it there are no messages; the library never writes to
 * stdout or stderr. */
typedef void (*pp_log_function)(void* user, int32_t level, const char* line);

/** Watches calls that take long. Both functions may be null. They are called some 50 times a second on the calling
 * thread, which waits while a thread of palpate does the work and calls log functions and force laws. They must return
 * at once, must not call anything on the object of the call, and must not throw. To end a call from another thread or a
 * signal handler, set a flag that `stop` reads. */
typedef struct pp_watch {
  /** Return other than 0 to end the call with PP_ERROR_STOPPED: within 0.2 s, unless one tick, edit, step or pass on
   * the GPU takes longer. Nothing is opened, read, written or meshed then; ticks, strokes and steps done so far remain,
   * as if the path had ended there. */
  int32_t (*stop)(void* user);
  void (*progress)(void* user, const char* what, double share); /**< share of the task `what` that is done, 0 to 1 */
  void* user;                                                   /**< passed to both */
} pp_watch;

/** @} */

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
/** Creates a cloud from arrays, which are copied. PP_ERROR_ARGUMENT names the first row with an invalid number. */
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
 * only when it is complete. Options may be null. PP_ERROR_FILE if it cannot be written. */
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
  const char* type; /**< int8 uint8 int16 uint16 int32 uint32 float32 float64 */
  const void* data; /**< one for each point; valid until the cloud is closed, as the name is */
} pp_attribute;
/** Number of such attributes of a cloud. */
PP_API pp_status pp_cloud_attribute_count(pp_cloud cloud, uint64_t* count);
/** One of the attributes, by its index from 0. PP_ERROR_ARGUMENT if the index is out of range. */
PP_API pp_status pp_cloud_get_attribute(pp_cloud cloud, uint64_t index, pp_attribute* attribute);
/** Closes the handle and invalidates its views; sessions of the cloud are not affected. */
PP_API pp_status pp_cloud_close(pp_cloud cloud);

/** @} */

/** @defgroup gpus GPUs
 * @{ */

/** Number of GPUs that Vulkan finds here, including software drivers; 0 without Vulkan. */
PP_API pp_status pp_gpu_count(uint32_t* count);
/** Copies the name of a GPU, by its index from 0, with its terminator, cut off to `capacity` bytes. PP_ERROR_ARGUMENT
 * if the index is out of range. */
PP_API pp_status pp_gpu_name(uint32_t index, char* name, uint64_t capacity);

/** @} */

#include <palpate/vulkan.h>

/** @defgroup sessions Sessions: a cloud that is felt, seen and sculpted
 * @{ */

/** Handle of a session. See the beginning of palpate.h for the threads that may use it. */
typedef struct pp_session {
  uint64_t id; /**< 0 is null */
} pp_session;

/** Position of a hand at a time. */
typedef struct pp_pose {
  double t_s;        /**< time, s */
  double hip[3];     /**< haptic interface point, model units */
  uint32_t no_edit;  /**< 1: only feels, even if the session has a brush */
  uint32_t reserved; /**< not used */
} pp_pose;

/** Answer of the surface to a pose. It is fresh (from the pose's own query), held (`valid` and not `fresh`: bridged
 * within the budget; the force fades as age_s grows, and is zero within 0.2 s) or none (not `valid`: a fault; no
 * force). */
typedef struct pp_contact {
  double proxy[3];       /**< position on the surface, model units; equals the HIP without contact */
  double normal[3];      /**< unit length, outward; zero if no surface was within reach */
  double force_N[3];     /**< force on the hand, N */
  double penetration_mm; /**< distance from HIP to proxy, mm; 0 without contact */
  uint32_t neighbours;   /**< points within the support radius */
  uint8_t contact;       /**< 1: the hand touches the surface */
  uint8_t fresh;         /**< 1: from this pose's own query; 0: bridged, because the answer would have been late */
  uint8_t valid;         /**< 0: a fault occurred, and the force is zero */
  uint8_t reserved;      /**< not used */
  double age_s;          /**< age of the data from which it was computed, s: 0 if fresh; negative: there are none */
} pp_contact;

/** One tick of the haptic loop. */
typedef struct pp_tick {
  double t_s;            /**< time, s */
  double hip[3];         /**< haptic interface point, model units */
  double proxy[3];       /**< as in pp_contact, and so are the fields below */
  double normal[3];      /**< unit length, outward */
  double force_N[3];     /**< force on the hand, N */
  double penetration_mm; /**< distance from HIP to proxy, mm */
  uint32_t neighbours;   /**< points within the support radius */
  uint8_t contact;       /**< 1: the hand touches the surface */
  uint8_t fresh;         /**< 1: from this tick's own query; 0: bridged */
  uint8_t valid;         /**< 0: a fault occurred, and the force is zero */
  uint8_t reserved;      /**< not used */
} pp_tick;

/** A force law of the program, in C or a compatible language: writes the force on the hand, N, for one tick of contact.
 * contact->force_N is the force of palpate's spring and damper. The limits of magnitude and rise still apply to the
 * result. Called on the servo thread in each tick: it must not allocate, wait or throw. */
typedef void (*pp_force_law)(void* user, const pp_pose* pose, const pp_contact* contact, double dt_s,
                             double force_N[3]);

/** Surface that the points define, and the force of the contact. */
typedef struct pp_contact_options {
  uint32_t size;             /**< bytes of this struct */
  uint32_t reserved;         /**< not used */
  const char* surface;       /**< "average", "sphere" or "sharp"; null: average */
  double friction;           /**< coefficient of sliding friction of the proxy; 0: none, at most 10 */
  double radius_mm;          /**< support radius; 0: from the spacing of the points. Fixed once the session is open. */
  double stiffness_N_per_mm; /**< of the spring from HIP to proxy, N/mm */
  double damping_N_s_per_mm; /**< of the damper on its change, N s/mm */
  double max_force_N;        /**< limit of the magnitude, N */
} pp_contact_options;
PP_OPTIONS(contact_options)

/** Tool of a hand: one point, or many points that share the stiffness, each with its own proxy. */
typedef struct pp_tool {
  uint32_t size;    /**< bytes of this struct */
  uint32_t points;  /**< number of points of a pad, ball or spatula, 1 to 64 */
  const char* kind; /**< "point", "pad" (a fingertip), "ball" or "spatula"; null: point */
  double size_mm;   /**< diameter of a pad or ball, length of a spatula, mm */
  /** Direction of the face of a pad or spatula without rotation, in the model's axes; of any length but 0. */
  double axis[3];
} pp_tool;
PP_OPTIONS(tool)

/** Maximum number of hands in one session. */
#define PP_MAX_HANDS 8

/** How a session is opened. */
typedef struct pp_session_options {
  uint32_t size;    /**< bytes of this struct */
  uint32_t threads; /**< threads of the CPU; 0: one per core */
  const char* gpu;  /**< number or part of a name; "cpu": no GPU, double precision; null: a GPU if there is one */
  /** Millimetres in the hand per model unit, the scale of all lengths in mm (1 for a scan in mm that is felt at its own
   * size); 0: as the cloud says, or else the longest side becomes 100 mm, which is reported to the log. A length of L
   * model units is L * pp_session_info.mm_per_unit mm. */
  double mm_per_unit;
  uint32_t estimate_normals;         /**< 1: even if the cloud has normals */
  uint32_t reserved;                 /**< not used */
  double rate_Hz;                    /**< ticks per second */
  const pp_contact_options* contact; /**< null: pp_default_contact_options() */
  /** pp_touch(): time limit of an answer, us, after which the last answer bridges it; 0: no limit. */
  double budget_us;
  double undo_memory_MiB;  /**< memory of strokes that can be undone, MiB; beyond it the oldest are discarded */
  pp_force_law law;        /**< null: spring and damper */
  void* law_user;          /**< passed to `law` */
  const char* law_library; /**< "libmine.so:function": a force law to load, instead of `law` */
  pp_log_function log;     /**< receives messages until the session is closed; null: none */
  void* log_user;          /**< passed to `log` */
  uint32_t hands;          /**< simultaneous hands, 1 to PP_MAX_HANDS; the first one sculpts, the others feel; 0: 1 */
  uint32_t reserved2;      /**< not used */
  const pp_tool* tool;     /**< tool of the first hand; null: a point. The other hands touch with a point. */
  const pp_vulkan_device* vulkan; /**< a device of the program, instead of a GPU by name; null: none */
  /** Watches this call and the long calls on the session: paths, pp_session_set_brush(), undo and redo,
   * pp_session_cloud(), pictures, meshes, pp_session_settle() and pp_live_start(). */
  pp_watch watch;
  /** "vulkan" (a GPU), "cpu" (double precision), or "auto": "vulkan" if a GPU is named or there is one other than a
   * software driver, else "cpu"; null: auto. With auto, a budget_us and no named GPU, a cloud at rest is answered by
   * the one of both that takes less time for a tick with an edit: it is measured for up to a second, reported to `log`,
   * and remembered in the user's cache folder. PP_ERROR_ARGUMENT if it conflicts with `gpu` or `vulkan`. */
  const char* backend;
} pp_session_options;
PP_OPTIONS(session_options)
/** Opens a session and builds its index; normals are estimated if the cloud has none. Options may be null.
 * PP_ERROR_ARGUMENT for a cloud without points or an option out of bounds, PP_ERROR_GPU if no GPU has that name or it
 * lacks a feature, PP_ERROR_FAILED if the force law cannot be loaded. */
PP_API pp_status pp_session_open(pp_cloud cloud, const pp_session_options* options, pp_session* session);
/** Opens a session of a scene of moving matter, in millimetres: "water", "sand", "jelly" or another built-in scene,
 * "FILE in water", "FILE in sand" or "soft FILE" with a closed cloud or mesh, or a JSON file. Each hand holds a ball in
 * water and sand, and presses on the surface of a soft body, whose shape a brush changes. By path, its time advances by
 * the duration of each path and continues with the next one; with a budget, and live, it follows the clock. The scene
 * restarts when the time of the ticks goes back, and when a live session begins or has ended. Options may be null.
 * PP_ERROR_ARGUMENT for an unknown scene; otherwise as for pp_session_open(). */
PP_API pp_status pp_session_open_matter(const char* scene, const pp_session_options* options, pp_session* session);
/** Closes the session, and ends its live session. */
PP_API pp_status pp_session_close(pp_session session);

/** Present state of a session. */
typedef struct pp_session_info {
  uint32_t size;       /**< bytes of this struct */
  uint32_t live;       /**< 1: a live session is running */
  uint64_t points;     /**< points of the cloud as opened */
  double mm_per_unit;  /**< millimetres in the hand per model unit */
  double spacing_mm;   /**< mean distance of neighbouring points, mm */
  double radius_mm;    /**< support radius, mm */
  double rate_Hz;      /**< ticks per second */
  uint64_t undo_count; /**< strokes that can be undone */
  uint64_t redo_count; /**< strokes that can be redone */
  uint64_t edits;      /**< states of points that brushes have made and that have been taken in so far */
  char backend[16];    /**< "vulkan" or "cpu" */
  char machine[112];   /**< name of the machine that answers; cut off to fit */
} pp_session_info;
PP_OPTIONS(session_info)
/** Present state of the session. */
PP_API pp_status pp_session_get_info(pp_session session, pp_session_info* info);

/** Path of a hand, model units. With 3 columns x y z: one row for each tick. With 4 columns, seconds first: times
 * increase from 0 or later, the hand moves on straight lines between the rows, and the path has as many ticks as fit
 * into the time of the last row. */
typedef struct pp_path {
  uint32_t size;     /**< bytes of this struct */
  int32_t type;      /**< pp_number: PP_FLOAT32 or PP_FLOAT64 */
  uint32_t columns;  /**< 3 or 4 */
  uint32_t reserved; /**< not used */
  uint64_t rows;     /**< number of rows, at least 1 */
  const void* data;  /**< the numbers of the first row */
  int64_t stride;    /**< bytes from one row to the next; 0: rows are contiguous */
} pp_path;
PP_OPTIONS(path)
/** Number of ticks of a path at the session's rate. With several hands, the longest of their paths counts.
 * PP_ERROR_ARGUMENT names the first invalid row. */
PP_API pp_status pp_path_ticks(pp_session session, const pp_path* path, uint64_t* count);

/** Follows the path in virtual time, as fast as possible, and only feels: the same path gives the same ticks.
 * `capacity` must be at least the number that pp_path_ticks() gives. PP_ERROR_GPU if ticks had no valid answer, and
 * PP_ERROR_STOPPED: `count` ticks are written, and those without an answer have valid 0 and no force. */
PP_API pp_status pp_session_touch(pp_session session, const pp_path* path, pp_tick* ticks, uint64_t capacity,
                                  uint64_t* count);

/** One tick, for a servo loop of the program, such as one at 1 kHz: takes a pose with its time and returns contact and
 * force. The first one after any other call begins a new contact and may take long: call it before the device has a
 * force. Later ones allocate nothing unless points are edited, take no lock that another thread holds for longer than
 * the copy of a pointer, and with pp_session_options.budget_us wait for no query beyond it: an answer that is late is
 * held (pp_contact). Times increase by the duration of a tick. Returns PP_OK even if contact->valid is 0; with any
 * other status there is no force. PP_ERROR_ARGUMENT for numbers that are not finite. */
PP_API pp_status pp_touch(pp_session session, const pp_pose* pose, pp_contact* contact);
/** One tick for all hands of a session: `poses`, `contacts`, `orientations` and `torques_mNm` have an entry for each of
 * the `hands` hands. The time of the first pose is used for all. `orientations`: rotation of each hand's tool, unit
 * quaternions w x y z; null: no rotation. `torques_mNm`: torques about the HIP, of tools and of balls in matter, 3 for
 * each hand; null: not wanted. PP_ERROR_ARGUMENT unless each hand of the session has a pose and each rotation is a unit
 * quaternion, PP_ERROR_STATE while the session is live. */
PP_API pp_status pp_touch_hands(pp_session session, const pp_pose* poses, const double* orientations, uint32_t hands,
                                pp_contact* contacts, double* torques_mNm);
/** Notifies the session that all hands were lifted: the next poses begin new contacts elsewhere. */
PP_API pp_status pp_touch_lift(pp_session session);

/** A brush changes the points within its reach while the hand is deeper than yield_depth_mm. */
typedef struct pp_brush {
  uint32_t size;         /**< bytes of this struct */
  uint32_t falloff;      /**< falloff towards the rim: (1 - r^2)^falloff; 0 to 16 */
  const char* kind;      /**< push carve inflate smooth grab paint flatten; null: push */
  double yield_depth_mm; /**< depth of the hand from which the surface yields, mm */
  double push_rate;      /**< push: share of the distance to its target that a point moves in one tick, 0 to 1 */
  double radius_mm;      /**< reach of the brush, mm in the hand */
  double strength;       /**< other brushes: share of the full effect applied in one tick, 0 to 1 */
  uint8_t color[4];      /**< paint: red green blue; the fourth is not used */
  uint32_t resample;     /**< 1: points are inserted where the surface is stretched, and merged where it is crowded */
} pp_brush;
PP_OPTIONS(brush)
/** Sets the brush of pp_touch() and of the next live hand; null: they only feel. PP_ERROR_STATE while the session is
 * live. The first brush of a session
 * rebuilds the index, so that points can be inserted and removed. PP_ERROR_ARGUMENT, with the reason, if the model does
 * not allow that brush, or if a setting is out of bounds. */
PP_API pp_status pp_session_set_brush(pp_session session, const pp_brush* brush);
/** Changes surface and force. `radius_mm` must be 0 or as the session was opened, or else the call returns
 * PP_ERROR_ARGUMENT. */
PP_API pp_status pp_session_set_contact(pp_session session, const pp_contact_options* contact);
/** pp_session_touch() with a brush for this path only. A stroke consists of all edits in one contact, with gaps of up
 * to 0.3 s. Errors as for pp_session_touch() and pp_session_set_brush(). */
PP_API pp_status pp_session_stroke(pp_session session, const pp_path* path, const pp_brush* brush, pp_tick* ticks,
                                   uint64_t capacity, uint64_t* count);
/** pp_session_touch() or pp_session_stroke() for all hands of a session: `paths` has a path for each of the `hands`
 * hands, and a hand stays where its path ends. `capacity` and `count` are numbers of rows: those of all hands in one
 * tick, in order, then those of the next tick. `brush`: of the first hand; null: it only feels. `torques_mNm`: torques
 * of tools about the HIP, 3 for each row; null: not wanted. PP_ERROR_ARGUMENT unless each hand of the session has a
 * path; otherwise as for pp_session_stroke(). */
PP_API pp_status pp_session_touch_hands(pp_session session, const pp_path* const* paths, uint32_t hands,
                                        const pp_brush* brush, pp_tick* ticks, double* torques_mNm, uint64_t capacity,
                                        uint64_t* count);
/** Undoes the last strokes; each point is restored to the last bit. `done`: number of strokes undone, fewer than
 * `strokes` if there are no more; may be null. PP_ERROR_ARGUMENT, with the reason, if the model does not allow it. */
PP_API pp_status pp_session_undo(pp_session session, uint64_t strokes, uint64_t* done);
/** Redoes the strokes undone last, as pp_session_undo() undoes them. */
PP_API pp_status pp_session_redo(pp_session session, uint64_t strokes, uint64_t* done);
/** Takes in the edits that pp_touch() with a budget, or a live hand, has made. Call it some thirty times a second:
 * edits are dropped once too many are pending. Pictures and pp_live_read_ticks() do it, too. In a joined session this
 * also sends the edits to the other programs; PP_ERROR_NETWORK once this hand's part in it has ended. */
PP_API pp_status pp_session_apply_edits(pp_session session);
/** Copies the present points into a new cloud. */
PP_API pp_status pp_session_cloud(pp_session session, pp_cloud* cloud);

/** @} */

#include <palpate/contacts.h>
#include <palpate/frames.h>
#include <palpate/live.h>
#include <palpate/logs.h>
#include <palpate/matter.h>
#include <palpate/pictures.h>
#include <palpate/placed_clouds.h>
#include <palpate/queries.h>
#include <palpate/sharing.h>

#ifdef __cplusplus
}
#endif
#undef PP_OPTIONS
#endif
