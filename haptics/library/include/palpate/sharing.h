/* palpate's C interface: sessions that several programs have, here or on other machines, over DDS. palpate.h includes
 * this. Where the library was built without DDS all of it gives PP_ERROR_UNSUPPORTED. */
#ifndef PALPATE_SHARING_H
#define PALPATE_SHARING_H
#ifndef PALPATE_H
#error "include <palpate/palpate.h>, which has this"
#endif

/* 1: this library was built with DDS. */
PP_API uint32_t pp_can_share(void);

/* Asked again and again by a call that waits for others, on the thread that waits, each twentieth of a second: other
 * than 0 ends the call with PP_ERROR_NETWORK. Calls nothing of palpate. */
typedef int32_t (*pp_stop_function)(void* user);

typedef struct pp_network {
  uint32_t size;
  uint32_t domain;            /* of DDS, as ROS numbers them: 0 to 230 */
  const char* interface_name; /* an interface of this machine, by name or address; null: programs of this machine alone.
                                 With it, whoever is on that network can take part, and without `security` nothing is
                                 encrypted. */
  const char* const* peers;   /* addresses of machines to look for, where the network carries no multicast */
  uint64_t peer_count;
  const char* security;  /* a folder of keys (palpate keys): all is encrypted, for holders of keys of the same authority
                            alone; null: none */
  pp_stop_function stop; /* ends pp_network_survey(), pp_session_join() and pp_serve() while they wait for others; null:
                            nothing does. Is called by none of them later. */
  void* stop_user;
} pp_network;
PP_OPTIONS(network)

/* A session that somebody serves. Names are what others have called themselves: cut off where there is no room, without
 * control characters, and perhaps no UTF-8. */
typedef struct pp_seen_session {
  char name[208], host[64], model[208]; /* what its points are, in its server's words */
  uint64_t points;
  double round_trip_ms; /* the median; below 0: no ping was answered */
  uint32_t version;     /* of what is said on the network */
  uint32_t fits;        /* 1: it is this library's version, and it can be joined */
  uint32_t pings, answered;
} pp_seen_session;
/* Listens for `seconds` (0 to 600), and then pings whom it has found, which takes half a second, and up to two more
 * where pings are lost. Copies the first `capacity` of them; `count` says how many there are. `network` may be null. */
PP_API pp_status pp_network_survey(const pp_network* network, double seconds, pp_seen_session* sessions,
                                   uint64_t capacity, uint64_t* count);

typedef struct pp_join_options {
  uint32_t size;
  uint32_t read_only;        /* 1: this hand feels what the others do, and takes no brush */
  const pp_network* network; /* null: pp_default_network() */
  const char* hand;          /* what the others see this hand called; null: as the machine */
  double patience_s;   /* for the session to be found, for each next piece of it, and, by path and where the points are
                          taken, for what everybody has done to be everywhere; above 0 */
  uint32_t near_hands; /* 1: of its points those around the hands alone come here, ahead of them; no stroke is taken
                          back, and nothing is recorded; what moves comes so in any case, and is felt live */
} pp_join_options;
PP_OPTIONS(join_options)
/* A session that another program serves (pp_serve(), `palpate serve`), by its name: a copy of its points, felt as those
 * of a cloud of one's own, by path, tick by tick and live. What a hand does to them goes to the server, and comes from
 * there to all others, whose strokes are felt between two ticks; at rest all have the same points, bit by bit. No
 * points come or go to keep the surface whole, whatever pp_brush.keeps_density says. Undo takes back this hand's
 * strokes, where nobody has changed the points since. While the server is silent for seconds the force fades, tick by
 * tick and live, until it is heard again: contact->valid stays 1. All hands are shown to the others, for a second after
 * their last tick. No session log is made of one that is sculpted. Options may be null. PP_ERROR_NETWORK where there is
 * no such session, or two of that name, or one of another version, and from any call that touches once this hand's part
 * has ended for good: the points can be taken then. */
PP_API pp_status pp_session_join(const char* name, const pp_join_options* join, const pp_session_options* options,
                                 pp_session* session);

/* How it goes with the others. */
typedef struct pp_sharing {
  uint32_t size;
  uint32_t sculptable; /* 0: it is served, or was joined, to be felt alone: what counts strokes is 0 */
  uint32_t heard;      /* 0: the server has been silent for so long that there is no force */
  uint32_t delivered;  /* 1: all that this hand has done has been taken by the server */
  uint32_t at_rest;    /* 1: and all that others have done is in effect here */
  uint32_t same;       /* 1: at rest, and the points are the server's, bit by bit */
  uint64_t sent;       /* states of points that this hand has made */
  uint64_t received;   /* that others have made, as they took effect here */
  uint64_t resent;     /* pieces of strokes that went more than once */
  uint64_t resumed;    /* times that what was missing was asked for, the first included */
  uint64_t pings, answered;
  double silent_s, longest_silent_s;    /* since the server was heard last */
  double round_trip_ms;                 /* the median of the last pings; below 0: none was answered yet */
  char name[208], host[64], model[208]; /* of the session, its server, and what its points are in that one's words */
  char fault[256];                      /* why this hand's part has ended for good; empty: it goes on */
  uint64_t
      restarts; /* times that what moves has begun again where it is served, as water does that was stirred too fast */
} pp_sharing;
PP_OPTIONS(sharing)
/* PP_ERROR_STATE for a session that was not joined, as the next ones. */
PP_API pp_status pp_session_get_sharing(pp_session session, pp_sharing* sharing);

/* Another program's hand, as it was heard last. Model units. */
typedef struct pp_other_hand {
  char name[208];
  uint32_t number; /* the same on all machines, for as long as it takes part */
  uint32_t touching, sculpts, reserved;
  double position[3]; /* of what it touches with */
  double proxy[3];    /* where the surface holds that */
  double age_s;       /* since it was heard */
} pp_other_hand;
/* Those that were heard within two seconds. Copies the first `capacity` of them; `count` says how many there are. */
PP_API pp_status pp_session_others(pp_session session, pp_other_hand* hands, uint64_t capacity, uint64_t* count);

/* From where a picture of the points is seen. Model units. */
typedef struct pp_camera_place {
  double position[3];
  double
      orientation[4]; /* a unit quaternion, x, y, z, w: x to the right of the picture, y down in it, z where it looks */
  double fov_deg;     /* vertical, above 0 and below 180 */
  double aspect;      /* width / height of the picture, 0.001 to 1000 */
} pp_camera_place;
/* From where another program's picture is seen, as it was heard last. */
typedef struct pp_other_camera {
  char name[208];  /* of its hand */
  uint32_t number; /* that hand's */
  uint32_t reserved;
  pp_camera_place place;
  double age_s; /* since it was heard */
} pp_other_camera;
/* Those that were heard within two seconds, of whoever has joined: also of a session that is felt alone, or near its
 * hands. Copies the first `capacity` of them; `count` says how many there are. */
PP_API pp_status pp_session_cameras(pp_session session, pp_other_camera* cameras, uint64_t capacity, uint64_t* count);
/* From now on the others are shown this camera, at most 30 times a second; null: none, as at first. Nobody is told of
 * pictures that pp_session_render() makes unless this says it. */
PP_API pp_status pp_session_show_camera(pp_session session, const pp_camera_place* camera);

/* Asks the server how far it is, and takes part in what the others do until all that the server had taken before this
 * call is in effect here and all that was done here is with the server; at most `seconds`. `same`: whether it is, and
 * the points are the server's; 0 where the server does not answer; may be null. Not while it is live. */
PP_API pp_status pp_session_settle(pp_session session, double seconds, uint32_t* same);

/* --- A cloud that others join. --------------------------------------------------------------------------------------
 */

typedef struct pp_server {
  uint64_t id; /* 0 is null */
} pp_server;

typedef struct pp_serve_options {
  uint32_t size;
  uint32_t read_only;        /* 1: whoever joins feels it, and does not sculpt it */
  const pp_network* network; /* null: pp_default_network() */
  const char* model;         /* what the points are, in words; null: the name of the cloud's file */
  double mm_per_unit;        /* millimetres per model unit; 0: as the cloud says, or the longest side becomes 100 mm */
  uint32_t estimate_normals; /* 1: also where the cloud has some */
  uint32_t threads;          /* of the CPU, for that; 0: one per core */
  const char* journal; /* a file that each stroke goes into as it is taken: whoever serves the cloud again with it goes
                          on where this ends, and so do those who have joined; null: none */
  pp_log_function log; /* hears who comes; null: nobody. Until the server is closed. */
  void* log_user;
  pp_watch watch; /* of pp_serve() */
} pp_serve_options;
PP_OPTIONS(serve_options)
/* Serves the cloud under a name of 1 to 200 bytes that no other session of the network has, on a thread of its own,
 * until it is closed. Normals are estimated where it has none. Options may be null. It takes a second, in which another
 * session of the name would be heard. */
PP_API pp_status pp_serve(pp_cloud cloud, const char* name, const pp_serve_options* options, pp_server* server);

typedef struct pp_server_info {
  uint32_t size;
  uint32_t serving; /* 0: it has ended by itself, for what `fault` says */
  uint64_t points;
  uint64_t clients;        /* that have ever asked for points */
  uint64_t sculptors;      /* clients of whom strokes were taken */
  uint64_t pieces, states; /* of strokes that were taken, and states of points in them */
  uint64_t sent;           /* states, to all who follow */
  uint64_t refused;        /* requests, and pieces of strokes, that no client of ours makes */
  double mm_per_unit;
  char openness[256]; /* who can join, in a sentence */
  char fault[256];
} pp_server_info;
PP_OPTIONS(server_info)
PP_API pp_status pp_server_get_info(pp_server server, pp_server_info* info);
/* The points as they are, as a cloud of its own: what has come of everybody's strokes. */
PP_API pp_status pp_server_cloud(pp_server server, pp_cloud* cloud);
/* Those who have joined keep what they have, and hear nothing any more. */
PP_API pp_status pp_server_close(pp_server server);

#endif
