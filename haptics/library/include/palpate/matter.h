/** @file
 * palpate's C interface: scenes of moving matter, in sessions and alone. palpate.h includes this. In a library built
 * without PALPATE_SIMULATION a scene gives PP_ERROR_UNSUPPORTED. */
#ifndef PALPATE_MATTER_H
#define PALPATE_MATTER_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which includes this header"
#endif

/** @defgroup matter Matter: water, sand and soft bodies
 * @{ */

/** 1 if this library was built with PALPATE_SIMULATION, else 0. */
PP_API uint32_t pp_can_simulate(void);

/** A parameter of a scene that can be changed while the scene moves. */
typedef struct pp_parameter {
  char name[32];  /**< as in JSON scenes */
  char label[48]; /**< for display */
  char unit[16];  /**< empty: dimensionless */
  double value;   /**< present value, in `unit` */
  double low;     /**< minimum of the value */
  double high;    /**< maximum of the value */
} pp_parameter;

/** Handle of moving points at one time; immutable. */
typedef struct pp_frame {
  uint64_t id; /**< 0 is null */
} pp_frame;

/** View of a frame. */
typedef struct pp_moving_points {
  pp_points points;        /**< with normals in a session */
  const float* velocities; /**< 3 for each point, model units per second */
  uint64_t moving; /**< number of moving points, which come first; the rest belong to bodies standing in the scene */
  double t_s;      /**< time of the points, s */
} pp_moving_points;
/** Read-only view of the frame; nothing is copied. Valid until the frame is closed. */
PP_API pp_status pp_frame_view(pp_frame frame, pp_moving_points* points);
/** Closes the handle and invalidates its views. */
PP_API pp_status pp_frame_close(pp_frame frame);

/** Present points of a session of matter or of frames. While the session is live, waits up to 50 ms for a newer frame.
 * PP_ERROR_STATE if the points of the session do not move. */
PP_API pp_status pp_session_frame(pp_session session, pp_frame* frame);
/** Pauses the scene while `on` is 1: it stands still, and no hand feels it. */
PP_API pp_status pp_session_pause(pp_session session, uint32_t on);
/** Restarts the scene with the next tick; the changes of a brush remain, and times of pp_touch() may begin again. */
PP_API pp_status pp_session_reset(pp_session session);
/** Number of the scene's parameters. */
PP_API pp_status pp_session_parameter_count(pp_session session, uint64_t* count);
/** One of the parameters, by its index from 0. PP_ERROR_ARGUMENT if the index is out of range. */
PP_API pp_status pp_session_get_parameter(pp_session session, uint64_t index, pp_parameter* parameter);
/** Sets a parameter from the next step on. PP_ERROR_ARGUMENT, without effect, for an unknown name or a value out of
 * bounds. */
PP_API pp_status pp_session_set_parameter(pp_session session, const char* name, double value);

/** State of a scene's motion. */
typedef struct pp_motion {
  uint32_t size;    /**< bytes of this struct */
  uint32_t paused;  /**< 1: paused by pp_session_pause() */
  uint32_t failed;  /**< 1: no answer is valid until the scene is reset */
  uint32_t hands;   /**< number of hands, and of valid energies */
  char failure[64]; /**< reason, as a predicate of "the simulation"; empty while it has not failed */
  double dropped_s; /**< time by which the scene fell behind the clock, and which was skipped, s */
  /** Energy that each hand has put into the scene since it began, less what it got back, J, from the forces that the
   * hand got, with their gain and after all limits. A hand is passive if its minimum is never below 0. */
  double energy_J[PP_MAX_HANDS];
  double min_energy_J[PP_MAX_HANDS]; /**< minimum of energy_J so far */
} pp_motion;
PP_OPTIONS(motion)
/** State of the scene's motion. PP_ERROR_STATE if the session's points do not move by themselves, as from
 * pp_session_pause() and those after it. */
PP_API pp_status pp_session_get_motion(pp_session session, pp_motion* motion);

/** Handle of a scene without hands. Only one thread may use it at a time. */
typedef struct pp_matter {
  uint64_t id; /**< 0 is null */
} pp_matter;

/** How pp_matter_open() opens a scene. */
typedef struct pp_matter_options {
  uint32_t size;                  /**< bytes of this struct */
  uint32_t threads;               /**< threads of the CPU; 0: one per core */
  const char* gpu;                /**< as in pp_session_options */
  pp_log_function log;            /**< receives messages of pp_matter_open(); null: none */
  void* log_user;                 /**< passed to `log` */
  const pp_vulkan_device* vulkan; /**< as in pp_session_options */
  pp_watch watch;                 /**< watches pp_matter_open() and pp_matter_step() */
  const char* backend;            /**< as in pp_session_options, but "auto" is the CPU for soft bodies */
} pp_matter_options;
PP_OPTIONS(matter_options)
/** Opens a scene, named as for pp_session_open_matter(). The same scene gives the same bytes on the same machine, with
 * any number of threads. Options may be null. PP_ERROR_ARGUMENT for an unknown scene, PP_ERROR_GPU as for
 * pp_session_open(). */
PP_API pp_status pp_matter_open(const char* scene, const pp_matter_options* options, pp_matter* matter);
/** Closes the scene; its frames remain valid. */
PP_API pp_status pp_matter_close(pp_matter matter);
/** Advances the scene by `steps` milliseconds. PP_ERROR_SIMULATION if it fails meanwhile: it stays at that time. */
PP_API pp_status pp_matter_step(pp_matter matter, uint64_t steps);
/** Restarts the scene, with the parameters that were set. */
PP_API pp_status pp_matter_reset(pp_matter matter);
/** Copies the present particles, or the surface of a soft body, in mm. */
PP_API pp_status pp_matter_frame(pp_matter matter, pp_frame* frame);
/** Number of the scene's parameters. */
PP_API pp_status pp_matter_parameter_count(pp_matter matter, uint64_t* count);
/** One of the parameters, by its index from 0. PP_ERROR_ARGUMENT if the index is out of range. */
PP_API pp_status pp_matter_get_parameter(pp_matter matter, uint64_t index, pp_parameter* parameter);
/** Sets a parameter from the next step on. PP_ERROR_ARGUMENT, without effect, for an unknown name or a value out of
 * bounds. */
PP_API pp_status pp_matter_set_parameter(pp_matter matter, const char* name, double value);

/** Sums over all particles of a scene at one time. */
typedef struct pp_matter_state {
  uint32_t size;             /**< bytes of this struct */
  uint32_t failed;           /**< 1: failed; reset it to continue */
  uint32_t substeps;         /**< steps of the solver per millisecond */
  uint32_t reserved;         /**< not used */
  uint64_t particles;        /**< particles, or nodes of a soft body */
  uint64_t inside_model;     /**< particles inside a body standing in the scene */
  double t_s;                /**< time since the scene began, s */
  double kinetic_J;          /**< kinetic energy, J */
  double potential_J;        /**< potential energy in gravity, J, relative to the corner at 0 */
  double momentum_kg_m_s[3]; /**< momentum, kg m/s */
  double max_compression;    /**< share by which the maximum density exceeds the density at rest */
  double front_mm;           /**< maximum x that matter has reached, mm */
  double on_model_N[3];      /**< mean force of the last step on the body standing in the scene, N; 0 without one */
  char machine[112];         /**< name of the machine that simulates; cut off to fit */
} pp_matter_state;
PP_OPTIONS(matter_state)
/** Computes the state, from all particles. */
PP_API pp_status pp_matter_get_state(pp_matter matter, pp_matter_state* state);

/** @} */

#endif
