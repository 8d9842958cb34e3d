/* palpate: feel, see and sculpt point clouds in real time. The C interface.
 *
 * Units: positions in model units (the coordinates of the cloud's file), lengths that a hand feels in mm, forces in N,
 * stiffness in N/mm, times in s. Axes are right-handed.
 *
 * Errors: every function that can fail returns a pp_status. What went wrong stands in words in pp_last_error(), for
 * each thread its own, until another call of that thread fails. Nothing is thrown, and nothing ends the program. What a
 * call fills is zero where it fails: contacts have no force and are not valid, counts and handles are 0.
 *
 * Handles are small values that may be copied. One that is null, closed, or of another kind gives PP_ERROR_HANDLE.
 * Whoever opens closes, in any order: a session keeps what it needs of its cloud.
 *
 * Threads: clouds, meshes, frames and logs are never changed, and may be used by any number of threads. Of a session
 * one thread may call pp_touch(), pp_touch_hands() and pp_touch_lift() (its servo thread) while another one looks:
 * pp_session_follow(), pp_session_render(), pp_session_mesh(), pp_session_get_info(), pp_session_frame(), what governs
 * matter (pp_session_hold() and those after it), pp_session_get_sharing(), pp_session_others(), pp_session_cameras(),
 * pp_session_show_camera(), pp_live_take(), pp_live_get_state(). All other calls want it for themselves, as all calls
 * on a pp_matter do. A pp_server is for any number of threads. Two calls that do not go together: the later one gives
 * PP_ERROR_THREAD and does nothing. In a process that was forked, a session, matter and a server of the parent's give
 * PP_ERROR_STATE, and closing them there ends nothing of the parent's.
 *
 * Options: a struct that begins with `size` is filled by its pp_default_…() function, and then changed. That is
 * compiled into the program and hands the size that it knows to pp_init_…(), which a program in another language calls
 * itself; so a library that is newer than the program takes the defaults for what the program does not know.
 */
#ifndef PALPATE_H
#define PALPATE_H

#include <stddef.h>
#include <stdint.h>

#define PALPATE_VERSION_MAJOR 0
#define PALPATE_VERSION_MINOR 1
#define PALPATE_VERSION_PATCH 0

#if defined(_WIN32)
#define PP_API
#else
#define PP_API __attribute__((visibility("default")))
#endif

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

/* What came of a call. */
typedef enum pp_status {
  PP_OK = 0,
  PP_ERROR_ARGUMENT = 1,    /* null, out of its bounds, of the wrong size, or does not go with another one */
  PP_ERROR_HANDLE = 2,      /* null, closed, or of another kind */
  PP_ERROR_THREAD = 3,      /* another thread is in a call that does not go with this one */
  PP_ERROR_STATE = 4,       /* not now: as long as the session is live, say */
  PP_ERROR_FILE = 5,        /* cannot be read or written; see pp_last_error_file() */
  PP_ERROR_GPU = 6,         /* there is none, it lacks something, or it is lost */
  PP_ERROR_MEMORY = 7,      /* of the host */
  PP_ERROR_DEVICE = 8,      /* the haptic device failed */
  PP_ERROR_UNSUPPORTED = 9, /* this palpate was built without it */
  PP_ERROR_FAILED = 10,     /* anything else; the words say what and what to do */
  PP_ERROR_BUG = 11,        /* of palpate: close what the call was about, and report the words */
  PP_ERROR_SIMULATION = 12, /* matter has diverged, or is too dense to be simulated; it goes on once it is reset */
  PP_ERROR_NETWORK = 13,    /* nobody serves what was asked for, its server is gone, or the network cannot be used */
  PP_ERROR_STOPPED = 14     /* the function of a pp_watch wanted that; what was done until then is whole */
} pp_status;

/* "0.1.0", of the library that runs. */
PP_API const char* pp_version(void);
/* "argument", "file"; "unknown" for a number that is no status. */
PP_API const char* pp_status_name(int status);

/* Of the last call of this thread that failed; PP_OK and empty before one has. The text stays until another one fails.
 */
PP_API pp_status pp_last_status(void);
PP_API const char* pp_last_error(void);
/* Where it was about a file: its name, and the line, or 0 where none is known. */
PP_API const char* pp_last_error_file(void);
PP_API uint64_t pp_last_error_line(void);

/* Remarks, one line each without its end. On any thread of the call, session or server that it was given to, until that
 * is over. What it calls of sessions, matter and servers gives PP_ERROR_STATE. */
typedef void (*pp_log_function)(void* user, const char* line);

/* Who watches calls that take long: both functions, of which either may be null, are called some 50 times a second on
 * the thread of the call, which waits, while a thread of palpate's does the work and calls log functions and force
 * laws. They return at once, call nothing of what the call is about, and throw nothing. A flag that another thread or a
 * signal's handler sets, and that `stop` reads, ends a call from there. */
typedef struct pp_watch {
  /* Not 0: the call ends with PP_ERROR_STOPPED, within 0.2 s where a tick, an edit, a step or a pass on the GPU does
   * not take longer. What was opened, read, written or meshed is not there then; ticks, strokes and steps that were
   * done are, as if the path had ended there. */
  int32_t (*stop)(void* user);
  void (*progress)(void* user, const char* what, double share); /* `share` of `what` is done, 0 to 1 */
  void* user;
} pp_watch;

/* --- Clouds: points with normals and colours, never changed once they are made. ------------------------------------
 */

typedef struct pp_cloud {
  uint64_t id; /* 0 is null */
} pp_cloud;

typedef enum pp_number { PP_FLOAT32 = 0, PP_FLOAT64 = 1, PP_UINT8 = 2, PP_UINT16 = 3 } pp_number;

/* Numbers of points, a row for each. */
typedef struct pp_rows {
  const void* data; /* null: there are none */
  int32_t type;     /* pp_number */
  int32_t reserved; /* 0 */
  int64_t stride;   /* bytes from a row to the next; 0: the rows follow one another */
} pp_rows;

typedef struct pp_cloud_arrays {
  uint32_t size; /* bytes of this struct */
  uint32_t reserved;
  uint64_t count;    /* points */
  pp_rows positions; /* x y z, PP_FLOAT32 or PP_FLOAT64; doubles keep their precision */
  pp_rows normals;   /* PP_FLOAT32 or PP_FLOAT64; made unit length */
  pp_rows colors;    /* red green blue: PP_UINT8 0 to 255, PP_UINT16 0 to 65535, PP_FLOAT32 and PP_FLOAT64 0 to 1,
                        or 0 to 255 where any is above 1; nothing else is a colour */
} pp_cloud_arrays;
PP_OPTIONS(cloud_arrays)
/* Copies the arrays. */
PP_API pp_status pp_cloud_create(const pp_cloud_arrays* arrays, pp_cloud* cloud);

typedef struct pp_read_options {
  uint32_t size;
  uint32_t all_points;         /* 1: of a reconstruction also those that its own measures tell to be unreliable */
  uint32_t normals_from_faces; /* 1: area-weighted, in place of any that the file gives */
  uint32_t reserved;
  pp_log_function log; /* hears what is not kept of the file; null: nobody */
  void* log_user;
  pp_watch watch; /* of this call */
} pp_read_options;
PP_OPTIONS(read_options)
/* Any format of pp_formats_read(), by what the file holds or by its ending. Options may be null. */
PP_API pp_status pp_cloud_read(const char* file, const pp_read_options* options, pp_cloud* cloud);

typedef struct pp_write_options {
  uint32_t size;
  uint32_t ascii; /* 1: where the format has both, shortest decimals that read back as the same number */
  uint32_t keep;  /* 1: a file that is there already is kept as NAME.EXT.bak; 0: it is replaced */
  uint32_t reserved;
  pp_watch watch; /* of this call */
} pp_write_options;
PP_OPTIONS(write_options)
/* By the file's ending, one of pp_formats_written(). It appears under its name only when it is whole. Options may be
 * null. */
PP_API pp_status pp_cloud_write(pp_cloud cloud, const char* file, const pp_write_options* options);
/* ".ply, .las, …" */
PP_API const char* pp_formats_read(void);
PP_API const char* pp_formats_written(void);

/* Where the points lie in memory, to look at; nothing is copied. Valid until the cloud is closed. */
typedef struct pp_points {
  uint64_t count;
  double origin[3];       /* file coordinates = origin + position; not zero where float32 alone would not do */
  const float* positions; /* 3 for each point, relative to origin */
  const float* normals;   /* 3 for each, unit; null: there are none */
  const uint8_t* colors;  /* red green blue alpha of each, 0 to 255; null: there are none */
  double min[3], max[3];  /* of the box that holds them, file coordinates; 0 without points */
} pp_points;
PP_API pp_status pp_cloud_view(pp_cloud cloud, pp_points* points);
/* Copies the positions in file coordinates, as well as they are known: 3 for each of the `count` points. */
PP_API pp_status pp_cloud_copy_places(pp_cloud cloud, double* places, uint64_t count);

/* A number for each point that the file has besides, as an intensity; carried through to files. */
typedef struct pp_attribute {
  const char* name;
  const char* type; /* int8 uint8 int16 uint16 int32 uint32 float32 float64 */
  const void* data; /* one for each point; valid until the cloud is closed, as the name is */
} pp_attribute;
PP_API pp_status pp_cloud_attribute_count(pp_cloud cloud, uint64_t* count);
PP_API pp_status pp_cloud_get_attribute(pp_cloud cloud, uint64_t index, pp_attribute* attribute);
PP_API pp_status pp_cloud_close(pp_cloud cloud);

/* --- GPUs. ---------------------------------------------------------------------------------------------------------
 */

/* Those that Vulkan has here, software drivers among them; 0 where there is no Vulkan. */
PP_API pp_status pp_gpu_count(uint32_t* count);
/* With its end, into `name`, cut off after `capacity` bytes. */
PP_API pp_status pp_gpu_name(uint32_t index, char* name, uint64_t capacity);

#include <palpate/vulkan.h>

/* --- Sessions: a cloud that is felt, seen and sculpted. ------------------------------------------------------------
 */

typedef struct pp_session {
  uint64_t id; /* 0 is null */
} pp_session;

/* Where a hand is, and when. */
typedef struct pp_pose {
  double t_s;
  double hip[3];  /* haptic interface point, model units */
  uint32_t feels; /* 1: only feels, although the session has a brush */
  uint32_t reserved;
} pp_pose;

/* What the surface answers to a pose. */
typedef struct pp_contact {
  double proxy[3];       /* model units; the HIP where nothing is touched */
  double normal[3];      /* unit, outward; zero where no surface was in reach */
  double force_N[3];     /* on the hand */
  double penetration_mm; /* from HIP to proxy; 0 where nothing is touched */
  uint32_t neighbours;   /* points within the support radius */
  uint8_t contact;       /* 1: something is touched */
  uint8_t fresh;         /* 1: from this pose's own query; 0: bridged, for the answer would have come too late */
  uint8_t valid;         /* 0: a fault; the force is zero */
  uint8_t reserved;
} pp_contact;

/* One tick of the haptic loop. */
typedef struct pp_tick {
  double t_s;
  double hip[3];
  double proxy[3];
  double normal[3];
  double force_N[3];
  double penetration_mm;
  uint32_t neighbours;
  uint8_t contact, fresh, valid, reserved;
} pp_tick;

/* A force law of your own, in C or anything that compiles to it: writes the force on the hand, N, of one tick of
 * contact. contact->force_N is that of palpate's own spring and damper. Limits of size and rise still act on what it
 * writes. On the servo thread, each tick: it allocates nothing, waits for nobody and throws nothing. */
typedef void (*pp_force_law)(void* user, const pp_pose* pose, const pp_contact* contact, double dt_s,
                             double force_N[3]);

/* What the points define, and how it is felt. */
typedef struct pp_feel {
  uint32_t size;
  uint32_t reserved;
  const char* surface; /* "average", "sphere" or "sharp"; null: average */
  double friction;     /* coefficient of a proxy that slides; 0: none, 10: the most */
  double radius_mm;    /* support radius; 0: by the spacing of the points. Only as the session is opened. */
  double stiffness_N_per_mm;
  double damping_N_s_per_mm;
  double max_force_N;
} pp_feel;
PP_OPTIONS(feel)

/* What touches: a point, or many that share the stiffness, each with a proxy of its own. */
typedef struct pp_tool {
  uint32_t size;
  uint32_t points;  /* of a pad, ball or spatula, 1 to 64 */
  const char* kind; /* "point", "pad" (a fingertip), "ball" or "spatula"; null: point */
  double size_mm;   /* diameter of a pad or ball, length of a spatula */
  double
      axis[3]; /* where the face of a pad or spatula looks while it is not turned; model's axes, of any length but 0 */
} pp_tool;
PP_OPTIONS(tool)

/* Hands that touch one session at most. */
#define PP_MOST_HANDS 8

typedef struct pp_session_options {
  uint32_t size;
  uint32_t threads;   /* of the CPU; 0: one per core */
  const char* gpu;    /* number or part of a name; "cpu": none, in double precision; null: a GPU where there is one */
  double mm_per_unit; /* millimetres in the hand per model unit, by which all lengths in mm are measured (1 for a scan
                         in mm that is felt at its own size); 0: as the cloud says, or the longest side becomes 100 mm,
                         as the log hears. A length in model units is pp_session_info.mm_per_unit times as many mm. */
  uint32_t estimate_normals; /* 1: also where the cloud has some */
  uint32_t reserved;
  double rate_Hz;      /* ticks per second */
  const pp_feel* feel; /* null: pp_default_feel() */
  double budget_us; /* pp_touch(): how long an answer may take before the last one bridges it; 0: as long as it takes */
  double undo_memory_MiB; /* for strokes that can be taken back; past it the oldest are forgotten */
  pp_force_law law;       /* null: spring and damper */
  void* law_user;
  const char* law_library; /* "libmine.so:function": a force law that is loaded, in place of `law` */
  pp_log_function log;     /* hears remarks; null: nobody. Until the session is closed. */
  void* log_user;
  uint32_t hands; /* that touch at the same time, 1 to PP_MOST_HANDS; the first one sculpts, the others feel; 0: 1 */
  uint32_t reserved2;
  const pp_tool* tool;            /* of the first hand; null: a point. The others touch with a point. */
  const pp_vulkan_device* vulkan; /* a device of the program's own, in place of one by name; null: there is none */
  /* Of this call, and of those on the session that take long: paths, pp_session_set_brush(), undo and redo,
   * pp_session_cloud(), pictures, meshes, pp_session_settle() and pp_live_start(). */
  pp_watch watch;
} pp_session_options;
PP_OPTIONS(session_options)
/* Builds the index; normals are estimated where the cloud has none. Options may be null. */
PP_API pp_status pp_session_open(pp_cloud cloud, const pp_session_options* options, pp_session* session);
/* The same of a scene of matter that moves by itself, in millimetres: "water", "sand", "jelly" or another one that is
 * built in, "FILE in water", "FILE in sand" or "soft FILE" with a closed cloud or mesh, or a JSON file. Each hand holds
 * a ball in water and sand, and presses on the surface of what is soft; of that a brush changes the shape. By path it
 * goes as far as the path does, from path to path; with a budget, and live, it follows the clock. Where time goes back,
 * and where a live session begins or has ended, the scene begins from the start. Options may be null. */
PP_API pp_status pp_session_open_matter(const char* scene, const pp_session_options* options, pp_session* session);
/* Ends it, and the live session with it. */
PP_API pp_status pp_session_close(pp_session session);

typedef struct pp_session_info {
  uint32_t size;
  uint32_t live;   /* 1: pp_live_start() has begun, and it has not ended */
  uint64_t points; /* that the cloud had */
  double mm_per_unit;
  double spacing_mm; /* mean, of neighbouring points */
  double radius_mm;  /* support radius */
  double rate_Hz;
  uint64_t undoable, redoable; /* strokes */
  uint64_t edits;              /* states of points, that brushes have made so far and that have been taken in */
  char backend[16];            /* "vulkan" or "cpu" */
  char machine[112];           /* that answers, in words; cut off */
} pp_session_info;
PP_OPTIONS(session_info)
PP_API pp_status pp_session_get_info(pp_session session, pp_session_info* info);

/* The way of a hand. With 3 columns x y z: a row for each tick. With 4, seconds first, which ascend from 0 or later: as
 * many ticks as the time of the last row holds, on straight lines between the rows. Model units. */
typedef struct pp_path {
  uint32_t size;
  int32_t type;     /* pp_number: PP_FLOAT32 or PP_FLOAT64 */
  uint32_t columns; /* 3 or 4 */
  uint32_t reserved;
  uint64_t rows;
  const void* data;
  int64_t stride; /* bytes from a row to the next; 0: the rows follow one another */
} pp_path;
PP_OPTIONS(path)
/* How many ticks a path takes at the session's rate. Where there are several hands, the longest of their paths counts.
 */
PP_API pp_status pp_path_ticks(pp_session session, const pp_path* path, uint64_t* count);

/* Follows the path in virtual time, as fast as it goes, and only feels: the same path gives the same ticks. `ticks` has
 * room for as many as pp_path_ticks() says. */
PP_API pp_status pp_session_touch(pp_session session, const pp_path* path, pp_tick* ticks, uint64_t capacity,
                                  uint64_t* count);

/* One tick, for a servo loop of your own. The first one after any other call begins a new contact and may take long;
 * those after it allocate nothing while nothing is edited, and with a budget take no longer than that by much. PP_OK
 * also where contact->valid is 0. */
PP_API pp_status pp_touch(pp_session session, const pp_pose* pose, pp_contact* contact);
/* The same for all hands of a session at once: `poses`, `contacts` and the others have `hands` of them, all of the same
 * time, that of the first one. `turns`: of each hand's tool, unit quaternions w x y z; null: none is turned.
 * `torques_mNm`: of tools, and of balls in matter, about the HIP, 3 for each hand; null: not wanted. */
PP_API pp_status pp_touch_hands(pp_session session, const pp_pose* poses, const double* turns, uint32_t hands,
                                pp_contact* contacts, double* torques_mNm);
/* All hands were lifted, and are put down elsewhere with the next poses. */
PP_API pp_status pp_touch_lift(pp_session session);

/* A brush changes the points that it reaches while the hand is deeper than tau_mm. */
typedef struct pp_brush {
  uint32_t size;
  uint32_t falloff; /* towards the rim: (1 - r^2)^falloff; 0 to 16 */
  const char* kind; /* push carve inflate smooth grab paint flatten; null: push */
  double tau_mm;    /* how deep a hand may stand before the surface yields */
  double beta;      /* push: share of the way to its target that a point goes in one tick, 0 to 1 */
  double radius_mm;
  double strength;        /* the others: how much of its effect a brush has in one tick, 0 to 1 */
  uint8_t color[4];       /* paint: red green blue; the fourth is not used */
  uint32_t keeps_density; /* 1: points come and go where the surface is stretched or crowded */
} pp_brush;
PP_OPTIONS(brush)
/* What pp_touch() and a live hand sculpt with from now on; null: they only feel. The first brush of a session builds
 * the index again, so that points can come and go. */
PP_API pp_status pp_session_set_brush(pp_session session, const pp_brush* brush);
PP_API pp_status pp_session_set_feel(pp_session session, const pp_feel* feel);
/* pp_session_touch() with a brush, for this one path. A stroke is all that is done in one contact, with
   gaps of up to 0.3 s. */
PP_API pp_status pp_session_stroke(pp_session session, const pp_path* path, const pp_brush* brush, pp_tick* ticks,
                                   uint64_t capacity, uint64_t* count);
/* pp_session_touch() or pp_session_stroke() for all hands of a session: `paths` has one for each of them, `hands` of
 * them, and a hand whose path has ended stays there. `ticks` and `capacity` count rows: those of all hands at a tick,
 * in order, and then those at the next one. `brush`: the first hand's; null: it only feels. `torques_mNm`: of tools,
 * about the HIP, 3 for each row; null: not wanted. */
PP_API pp_status pp_session_touch_hands(pp_session session, const pp_path* const* paths, uint32_t hands,
                                        const pp_brush* brush, pp_tick* ticks, double* torques_mNm, uint64_t capacity,
                                        uint64_t* count);
/* Takes back the last strokes, or does those again that were taken back last; each point is as it was, to the last bit.
 * `done`: how many there were; may be null. */
PP_API pp_status pp_session_undo(pp_session session, uint64_t strokes, uint64_t* done);
PP_API pp_status pp_session_redo(pp_session session, uint64_t strokes, uint64_t* done);
/* Takes in what pp_touch() with a budget, or a live hand, has done to the points: some thirty times a second, or edits
 * are left out once too many wait. Pictures and pp_live_take() do it, too. Of a session that was joined the others hear
 * of it then; PP_ERROR_NETWORK where this hand's part in that has ended. */
PP_API pp_status pp_session_follow(pp_session session);
/* The points as they are, as a cloud of its own. */
PP_API pp_status pp_session_cloud(pp_session session, pp_cloud* cloud);

typedef struct pp_picture_options {
  uint32_t size;
  uint32_t width, height;                               /* pixels */
  uint32_t samples;                                     /* of a pixel: 1 or 4 */
  uint32_t has_eye, has_target, has_up, has_background; /* 1: the next ones are given; 0: as fits the model */
  double eye[3], target[3], up[3];                      /* model units */
  double fov_deg;                                       /* vertical, 1 to 170 */
  const char* color;                                    /* "rgb", "normal", "depth" or "height"; null: rgb */
  uint8_t background[4];                                /* red green blue; the fourth is not used */
  uint32_t reserved;
} pp_picture_options;
PP_OPTIONS(picture_options)
/* Draws the points as they are into `rgba`: rows from the top, 4 bytes for each pixel; `bytes` says how many there is
 * room for. On the GPU that answers; for a session on the CPU on the best that there is. Options may be null. */
PP_API pp_status pp_session_render(pp_session session, const pp_picture_options* options, uint8_t* rgba,
                                   uint64_t bytes);
/* Writes a picture of such rows, as .png or .jpg. */
PP_API pp_status pp_image_write(const char* file, const uint8_t* rgba, uint32_t width, uint32_t height);

/* --- Meshes. -------------------------------------------------------------------------------------------------------
 */

typedef struct pp_mesh {
  uint64_t id; /* 0 is null */
} pp_mesh;

typedef struct pp_mesh_options {
  uint32_t size;
  uint32_t lattice;    /* cells along the longest side, 1 to 2048 */
  const char* surface; /* "sphere", "average", "sharp" or "density"; null: sphere */
  double radius_mm;    /* support radius; 0: by the spacing of the points */
} pp_mesh_options;
PP_OPTIONS(mesh_options)
/* Triangles around the points as they are, by marching cubes on a GPU, as for pp_session_render(). Options may be null.
 */
PP_API pp_status pp_session_mesh(pp_session session, const pp_mesh_options* options, pp_mesh* mesh);

typedef struct pp_triangles {
  pp_points vertices;        /* with normals */
  uint64_t count;            /* triangles */
  const uint32_t* triangles; /* 3 numbers of vertices for each, anticlockwise as seen from outside */
  uint32_t closed;           /* 1: it has no border */
  uint32_t reserved;
} pp_triangles;
/* Nothing is copied; valid until the mesh is closed. */
PP_API pp_status pp_mesh_view(pp_mesh mesh, pp_triangles* triangles);
PP_API pp_status pp_mesh_write(pp_mesh mesh, const char* file, const pp_write_options* options);
PP_API pp_status pp_mesh_close(pp_mesh mesh);

/* --- Live: a servo thread of palpate's own, with a haptic device. --------------------------------------------------
 */

typedef struct pp_live_options {
  uint32_t size;
  uint32_t reserved;
  const char* device;  /* openhaptics[:NAME] dhd[:NUMBER] hid[:WHICH] sim replay:FILE path; null: path */
  const char* builtin; /* of sim and path: "press", "slide", "scan" or "orbit", in place of `path` */
  const pp_path* path; /* of path: followed against the clock, and then the hand stays; copied */
  double rate_Hz;      /* ticks per second; 0: the session's */
  pp_force_law law;    /* null: the session's */
  void* law_user;
  const char* law_library; /* null: the session's */
  /* Of the next hand, where the session has several: its device, builtin, path, and its own `next`. Its rate is the
   * first one's, and a law is of the first hand alone. A device that would call the ticks is called by them. */
  const struct pp_live_options* next;
} pp_live_options;
PP_OPTIONS(live_options)
/* Begins ticks against the wall clock, on a thread of their own. Until pp_live_stop() a session does what looks at it,
 * and nothing else. Options may be null. */
PP_API pp_status pp_live_start(pp_session session, const pp_live_options* options);
/* Where there are several hands, `capacity` and `count` are of rows, as of pp_session_touch_hands(), of whole ticks.
 * Copies the ticks since the last call, as many as there is room for, and takes in what was done to the points. Ticks
 * that nobody takes for half a minute at 1 kHz are left out. Where the session has ended by itself, PP_ERROR_DEVICE or
 * PP_ERROR_GPU, once no ticks are left. PP_ERROR_NETWORK, with the ticks, as pp_session_follow(). */
PP_API pp_status pp_live_take(pp_session session, pp_tick* ticks, uint64_t capacity, uint64_t* count);

typedef struct pp_live_state {
  uint32_t size;
  uint32_t running; /* 0: it has ended by itself, or was never begun */
  uint64_t ticks;   /* taken so far, of this live session */
  uint64_t missed;  /* whose time had passed; of those before the last one taken */
} pp_live_state;
PP_OPTIONS(live_state)
PP_API pp_status pp_live_get_state(pp_session session, pp_live_state* state);
/* No force while `on` is 0; when it is 1 again, a ramp. From any thread, beside any other call. */
PP_API pp_status pp_live_set_forces(pp_session session, uint32_t on);
/* Waits for the tick under way; the device has no force then. What was not taken yet still can be. */
PP_API pp_status pp_live_stop(pp_session session);

#include <palpate/frames.h>
#include <palpate/logs.h>
#include <palpate/matter.h>
#include <palpate/sharing.h>

#ifdef __cplusplus
}
#endif
#undef PP_OPTIONS
#endif
