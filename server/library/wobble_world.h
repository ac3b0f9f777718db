// The physics of wobble for C (C11), and for every language that calls C: loads a scene, steps its soft bodies, and
// reads and writes their state. It plays recordings of servers, too. The library is libwobble_world.so; there is no
// network in it.
//
// Results: a function that can fail returns WOBBLE_WORLD_OK, a positive wobble_world_result that is no fault, or a
// negative one that says what cannot be; wobble_world_describe has a sentence for each. A call that fails changes
// nothing. No exception leaves the library.
//
// Structs: the first field, struct_size, is sizeof of the struct as the caller knows it. New fields come last, and the
// library touches no byte beyond struct_size, so a program works with an older or a newer library than it was compiled
// with. In structs that the library reads, 0 and NULL stand for the default.
//
// Memory: no pointer that you pass is kept after the call. Pointers to a world's memory are valid until the next call
// that changes that world (all that take a wobble_world* without const). But positions and velocities of a body of a
// scene's world, not of a recording, stay where they are, and are those of the present, until the body is removed or
// the world freed.
//
// Threads: different threads may use different worlds; several may read one world at a time while none changes it. A
// step takes as many threads as the options say. The same calls in the same order give the same bits, whatever the
// number of threads and whatever the processor.
//
// Units: metres, seconds, kilograms, newtons, joules. The world's z is up. Texts are UTF-8.
#ifndef WOBBLE_WORLD_H
#define WOBBLE_WORLD_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define WOBBLE_WORLD_API __attribute__((visibility("default")))

typedef int32_t wobble_world_result;
enum {
  WOBBLE_WORLD_OK = 0,
  WOBBLE_WORLD_AT_END = 1,      // the recording has no more ticks
  WOBBLE_WORLD_NULL = -1,       // a pointer is NULL that must not be
  WOBBLE_WORLD_BAD_SIZE = -2,   // struct_size is less than the struct has ever had
  WOBBLE_WORLD_BAD_FLAGS = -3,  // a bit is set that has no meaning
  WOBBLE_WORLD_BAD_VALUE = -4,  // a number is not finite or out of its range
  WOBBLE_WORLD_BAD_SCENE = -5,  // no such scene, or it has mistakes: the message names each
  WOBBLE_WORLD_BAD_FILE = -6,   // no such recording, or it is damaged: the message says where
  WOBBLE_WORLD_BAD_BODY = -7,   // there is no body of this number, index or blueprint
  WOBBLE_WORLD_RECORDED = -8,   // a recording plays what was recorded, and nothing else can change its world
  WOBBLE_WORLD_NO_MEMORY = -9,
  WOBBLE_WORLD_INTERNAL = -10,  // a defect of the library
};
// One line in English for any number; valid for ever.
WOBBLE_WORLD_API const char* wobble_world_describe(wobble_world_result result);
// Of the library, such as "0.1.0"; valid for ever.
WOBBLE_WORLD_API const char* wobble_world_version(void);

// 1. Make a world.

typedef struct wobble_world wobble_world;

enum {
  WOBBLE_WORLD_SINGLE = 1 << 0,  // 32-bit numbers, as the server computes: twice as fast
  WOBBLE_WORLD_DOUBLE = 1 << 1,  // 64-bit numbers
};

typedef struct wobble_world_options {
  uint32_t struct_size;
  uint32_t flags;       // WOBBLE_WORLD_SINGLE or WOBBLE_WORLD_DOUBLE; default: as the scene says
  const char* scene;    // name of a shipped scene such as "arena", or the path of a TOML file
  const char* text;     // a scene's TOML itself, in place of `scene`
  const char* folder;   // where names of scenes are looked for; default: the installed ones
  uint64_t seed;        // of the scene's random placement; default: 1
  double tick_rate;     // ticks a second, 1 to 1000; default: 60
  double error_target;  // m/s, 1e-12 to 1: error that may build up in a second of motion; default: the scene's
  uint32_t threads;     // 1 to 64; default: 1
  uint32_t substeps;    // fixed number a tick, 1 to 65536; default: as many as error_target and stability ask for
} wobble_world_options;

// Makes *world of a scene, with its bodies and without players. There are no rules of play: what falls goes on to fall.
// After a failure *world is NULL and `message`, if it is not NULL, has at most message_size bytes of what is wrong, one
// mistake a line, with a zero byte at the end.
WOBBLE_WORLD_API wobble_world_result wobble_world_load(const wobble_world_options* options, wobble_world** world,
                                                       char* message, size_t message_size);

// Makes *world of a recording that a server made (.wobrec), at its first tick. threads: 1 to 64. Else as
// wobble_world_load.
WOBBLE_WORLD_API wobble_world_result wobble_world_open_recording(const char* path, uint32_t threads,
                                                                 wobble_world** world, char* message,
                                                                 size_t message_size);

// Frees the world and all that it points to; NULL is allowed.
WOBBLE_WORLD_API void wobble_world_free(wobble_world* world);

// 2. Step.

// What the ticks of a call did. Counts of bodies are summed over the ticks.
typedef struct wobble_world_report {
  uint32_t struct_size;
  uint32_t ticks;        // that were played
  uint64_t substeps;     // summed over the bodies
  uint64_t awake;        // bodies that were stepped
  uint64_t non_finite;   // had a non-finite coordinate in one of the tries
  uint64_t inverted;     // ended a tick inside out
  uint64_t quarantined;  // were stepped again in more substeps, or reset
  uint64_t reset;        // were put back into their rest shapes
  uint64_t torn;         // springs that tore
} wobble_world_report;
// Plays so many ticks. report may be NULL. WOBBLE_WORLD_AT_END: a recording had fewer.
WOBBLE_WORLD_API wobble_world_result wobble_world_step(wobble_world* world, uint32_t ticks,
                                                       wobble_world_report* report);

// Goes to the state after so many ticks, from first_tick to last_tick; of recordings only.
WOBBLE_WORLD_API wobble_world_result wobble_world_seek(wobble_world* world, uint32_t tick);

// 3. Read.

typedef struct wobble_world_info {
  uint32_t struct_size;
  uint32_t tick;         // steps taken
  double tick_duration;  // s
  double time;           // tick * tick_duration
  double gravity[3];     // m/s^2
  uint32_t body_count;
  uint32_t blueprint_count;
  int32_t is_recording;
  uint32_t first_tick;  // of a recording; else 0
  uint32_t last_tick;
  uint32_t reserved;
  uint64_t hash;      // of every bit of every body's state; O(vertices)
  const char* scene;  // its name; valid as long as the world
} wobble_world_info;
WOBBLE_WORLD_API wobble_world_result wobble_world_read_info(const wobble_world* world, wobble_world_info* info);

// A body without copies. Vertex i is at origin + positions[3 i], [3 i + 1], [3 i + 2].
typedef struct wobble_world_body {
  uint32_t struct_size;
  uint32_t body;       // its number, which it keeps; from 1
  uint32_t blueprint;  // index of its kind
  uint32_t vertex_count;
  uint32_t face_count;
  uint32_t edge_count;
  int32_t is_double;  // which pair of pointers below is not NULL
  int32_t is_asleep;
  double origin[3];                // m; moves with the body now and then
  double mass;                     // kg
  const char* name;                // of the blueprint. This pointer and those below: see Memory above
  const float* positions_single;   // m, local
  const float* velocities_single;  // m/s
  const double* positions_double;
  const double* velocities_double;
  const double* rest;     // rest shape, its centre of mass at 0, m
  const double* masses;   // one a vertex, kg
  const uint16_t* faces;  // three vertices each, counter-clockwise seen from outside
  const uint16_t* edges;  // two vertices each: sides of faces, or springs of a body without faces
} wobble_world_body;
// index: from 0 to body_count - 1; bodies are in ascending order.
WOBBLE_WORLD_API wobble_world_result wobble_world_read_body(const wobble_world* world, uint32_t index,
                                                            wobble_world_body* body);

// J.
typedef struct wobble_world_energy {
  uint32_t struct_size;
  uint32_t reserved;
  double kinetic;
  double gravity;  // 0 at the world's origin
  double elastic;  // of springs, tetrahedra and hinges, with repulsion
  double gas;      // up to a constant
} wobble_world_energy;
// body: a number; 0: the sum over all. Without the energy that contacts store. O(vertices + springs).
WOBBLE_WORLD_API wobble_world_result wobble_world_read_energy(const wobble_world* world, uint32_t body,
                                                              wobble_world_energy* energy);

// Forces on each vertex of a body, kind by kind: they add up to mass times acceleration. Arrays of three numbers a
// vertex, yours; NULL: left out. N; accelerations in m/s^2.
typedef struct wobble_world_forces {
  uint32_t struct_size;
  uint32_t vertex_capacity;  // for which the arrays have room: at least the body's vertex_count
  double* elastic;
  double* damping;
  double* gas;
  double* weight;
  double* contact;
  double* other;
  double* accelerations;
} wobble_world_forces;
// As the body stands after the last step.
WOBBLE_WORLD_API wobble_world_result wobble_world_read_forces(const wobble_world* world, uint32_t body,
                                                              const wobble_world_forces* forces);

// 4. Act. None of these for a recording.

// Adds forces on vertices of a body that act through the next tick and no longer. vertices: count of them, each below
// vertex_count; NULL: 0, 1, 2 ... forces: three numbers each, N.
WOBBLE_WORLD_API wobble_world_result wobble_world_push(wobble_world* world, uint32_t body, uint32_t count,
                                                       const uint16_t* vertices, const double* forces);

// Sets where every vertex is in the world and how it moves: three numbers each. Fixed vertices stay at rest.
WOBBLE_WORLD_API wobble_world_result wobble_world_set_motion(wobble_world* world, uint32_t body, uint32_t vertex_count,
                                                             const double* positions, const double* velocities);

enum { WOBBLE_WORLD_JUMP = 1 << 0, WOBBLE_WORLD_PUFF = 1 << 1, WOBBLE_WORLD_STIFFEN = 1 << 2 };
// What a player would ask of the body; holds until the next call. move: x and y, of a length of at most 1, as a share
// of the scene's speed of players. buttons: WOBBLE_WORLD_JUMP ...
WOBBLE_WORLD_API wobble_world_result wobble_world_set_control(wobble_world* world, uint32_t body, const double move[2],
                                                              uint32_t buttons);

// m/s^2.
WOBBLE_WORLD_API wobble_world_result wobble_world_set_gravity(wobble_world* world, const double gravity[3]);

// Adds a body of the kind with this name; *body becomes its number. position: of its centre of mass. velocity may be
// NULL: at rest.
WOBBLE_WORLD_API wobble_world_result wobble_world_add_body(wobble_world* world, const char* blueprint,
                                                           const double position[3], const double velocity[3],
                                                           uint32_t* body);
WOBBLE_WORLD_API wobble_world_result wobble_world_remove_body(wobble_world* world, uint32_t body);

#ifdef __cplusplus
}
#endif

#endif  // WOBBLE_WORLD_H
