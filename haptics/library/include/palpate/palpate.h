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
 * pp_session_cameras(), pp_session_publish_camera(), pp_live_read_ticks(), pp_live_read_rows(), pp_live_get_state().
 * Where budget_us is 0, all of these but those that control matter and those of sharing.h conflict with pp_touch(),
 * too. All other calls on a session, and all calls on a pp_matter, need exclusive access. A pp_server may be used by
 * any number of threads. A call that conflicts with one in progress returns PP_ERROR_THREAD and does nothing; between
 * pp_live_start() and pp_live_stop() the commands of a live session, and the functions that look at it, wait instead,
 * 15 s at most (PP_ERROR_TIMEOUT). In a forked process, the parent's sessions, matter and servers give PP_ERROR_STATE,
 * and closing them there does not affect the parent; the network gives PP_ERROR_NETWORK if the parent was using it.
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
  PP_ERROR_DEVICE = 8,      /**< the haptic device failed, or cannot be opened */
  PP_ERROR_UNSUPPORTED = 9, /**< this build of palpate does not include it */
  PP_ERROR_FAILED = 10,     /**< any other failure; pp_last_error() says what failed and what to do */
  PP_ERROR_BUG = 11, /**< a bug of palpate: close the handles in question, and report the text of pp_last_error() */
  PP_ERROR_SIMULATION = 12, /**< matter has diverged, or is too dense to be simulated; reset it to continue */
  PP_ERROR_NETWORK = 13,    /**< no such session is served, its server is gone, or the network cannot be used */
  PP_ERROR_STOPPED = 14,    /**< a pp_watch function stopped the call; what was done until then is complete */
  PP_ERROR_TIMEOUT = 15     /**< a live session has not taken a command for 15 s; nothing has changed; stop it */
} pp_status;

/** Version of the library at run time, such as "0.1.0". */
PP_API const char* pp_version(void);
/** Name of a status, such as "argument" or "file"; "unknown" for any other number. */
PP_API const char* pp_status_name(int status);

/** Status of the last failed call of this thread; PP_OK before the first. */
PP_API pp_status pp_last_status(void);
/** Description of the last failed call of this thread: what is wrong, where, and what to do; empty before the first.
 * The text is this thread's own, of 8191 bytes at most, and stays at its address until the thread ends: only a call of
 * this thread that fails changes it, so it can stand in one expression with other calls. */
PP_API const char* pp_last_error(void);
/** File that the last failure is about; empty if none. Valid as long as pp_last_error(). */
PP_API const char* pp_last_error_file(void);
/** Line of that file, from 1; 0 if unknown. */
PP_API uint64_t pp_last_error_line(void);

/** Weight of a message. A failed call sends none: see its status and pp_last_error(). */
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

/** @defgroup gpus GPUs
 * @{ */

/** Number of GPUs that Vulkan finds here, including software drivers; 0 without Vulkan. */
PP_API pp_status pp_gpu_count(uint32_t* count);
/** Copies the name of a GPU, by its index from 0, with its terminator, cut off to `capacity` bytes. PP_ERROR_ARGUMENT
 * if the index is out of range. */
PP_API pp_status pp_gpu_name(uint32_t index, char* name, uint64_t capacity);

/** @} */

#include <palpate/clouds.h>
#include <palpate/sessions.h>
#include <palpate/touch.h>
#include <palpate/vulkan.h>

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
