/* palpate's C interface: matter that moves by itself, in sessions and alone. palpate.h includes this. */
#ifndef PALPATE_MATTER_H
#define PALPATE_MATTER_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which has this"
#endif

/* A number of a scene that can be changed while it moves. */
typedef struct pp_parameter {
  char name[32];  /* as scenes in JSON have it */
  char label[48]; /* for who reads */
  char unit[16];  /* empty: 1 */
  double value, low, high;
} pp_parameter;

/* Points that move, as they were at a time; never changed once it is taken. */
typedef struct pp_frame {
  uint64_t id; /* 0 is null */
} pp_frame;

typedef struct pp_moving_points {
  pp_points points;        /* of a session with normals */
  const float* velocities; /* 3 for each, model units per second */
  uint64_t moving;         /* the first so many move; those behind them are of what stands in the scene */
  double t_s;
} pp_moving_points;
/* Nothing is copied; valid until the frame is closed. */
PP_API pp_status pp_frame_view(pp_frame frame, pp_moving_points* points);
PP_API pp_status pp_frame_close(pp_frame frame);

/* The points of a session of matter, or of frames, as they are. While it is live that waits for a newer one, 50 ms at
 * most. */
PP_API pp_status pp_session_frame(pp_session session, pp_frame* frame);
/* It stands still, and no hand feels it, while `on` is 1. */
PP_API pp_status pp_session_hold(pp_session session, uint32_t on);
/* Everything goes back to where it began, with the next tick; what a brush has shaped stays. */
PP_API pp_status pp_session_reset(pp_session session);
PP_API pp_status pp_session_parameter_count(pp_session session, uint64_t* count);
PP_API pp_status pp_session_get_parameter(pp_session session, uint64_t index, pp_parameter* parameter);
/* From the next step on. Nothing is changed where there is none of that name, or the value is out of its bounds. */
PP_API pp_status pp_session_set_parameter(pp_session session, const char* name, double value);

typedef struct pp_motion {
  uint32_t size;
  uint32_t held;   /* 1: by pp_session_hold() */
  uint32_t failed; /* 1: no answer is valid until it is reset */
  uint32_t hands;
  char failure[64];  /* why, in words that follow "the simulation"; empty while it has not */
  double left_out_s; /* time by which it has stayed behind the clock, and which it leaves out */
  /* What each hand has put into it since it began, less what it got back, J, against the forces that it got, with
   * their gain and after all limits: passive where the least is never below 0. */
  double energy_J[PP_MOST_HANDS], least_energy_J[PP_MOST_HANDS];
} pp_motion;
PP_OPTIONS(motion)
PP_API pp_status pp_session_get_motion(pp_session session, pp_motion* motion);

/* A scene that no hand touches. For one thread at a time. */
typedef struct pp_matter {
  uint64_t id; /* 0 is null */
} pp_matter;

typedef struct pp_matter_options {
  uint32_t size;
  uint32_t threads;    /* of the CPU; 0: one per core */
  const char* gpu;     /* as in pp_session_options; null: the CPU for soft bodies */
  pp_log_function log; /* hears remarks of pp_matter_open(); null: nobody */
  void* log_user;
  const pp_vulkan_device* vulkan; /* as in pp_session_options */
  pp_watch watch;                 /* of pp_matter_open() and pp_matter_step() */
} pp_matter_options;
PP_OPTIONS(matter_options)
/* A scene as of pp_session_open_matter(). The same scene gives the same bytes on the same machine, for any number of
 * threads. Options may be null. */
PP_API pp_status pp_matter_open(const char* scene, const pp_matter_options* options, pp_matter* matter);
PP_API pp_status pp_matter_close(pp_matter matter);
/* So many milliseconds further. PP_ERROR_SIMULATION where it fails on the way: it stays where it was then. */
PP_API pp_status pp_matter_step(pp_matter matter, uint64_t steps);
/* Everything goes back to where it began, with the parameters that were set. */
PP_API pp_status pp_matter_reset(pp_matter matter);
PP_API pp_status pp_matter_frame(pp_matter matter, pp_frame* frame);
PP_API pp_status pp_matter_parameter_count(pp_matter matter, uint64_t* count);
PP_API pp_status pp_matter_get_parameter(pp_matter matter, uint64_t index, pp_parameter* parameter);
PP_API pp_status pp_matter_set_parameter(pp_matter matter, const char* name, double value);

typedef struct pp_matter_state {
  uint32_t size;
  uint32_t failed;   /* 1: it goes on once it is reset */
  uint32_t substeps; /* in a millisecond */
  uint32_t reserved;
  uint64_t particles;    /* or nodes of a soft body */
  uint64_t inside_model; /* particles that are within what stands in the scene */
  double t_s;
  double kinetic_J, potential_J; /* in gravity, from the corner at 0 */
  double momentum_kg_m_s[3];
  double max_compression; /* share by which the densest place exceeds the density at rest */
  double front_mm;        /* along x, how far matter has come */
  double on_model_N[3];   /* force on what stands in the scene, mean of the last step; 0 where nothing does */
  char machine[112];      /* that simulates, in words; cut off */
} pp_matter_state;
PP_OPTIONS(matter_state)
/* Looks at all particles. */
PP_API pp_status pp_matter_get_state(pp_matter matter, pp_matter_state* state);

#endif
