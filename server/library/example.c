// Steps a scene without a server, pushes one of its bodies, and prints once a second where it is and how much energy
// there is. C11, with libwobble_world.so alone:
//
//   cc -std=c11 example.c $(pkg-config --cflags --libs libwobble_world) -o study && ./study ball_drop 3
#include <stdio.h>
#include <stdlib.h>
#include <wobble_world.h>

static void Check(wobble_world_result result, const char* what) {
  if (result >= 0) return;
  fprintf(stderr, "study: %s: %s\n", what, wobble_world_describe(result));
  exit(1);
}

// Mean of the vertices of a body that is computed in 32 bits, m.
static double FindHeight(const wobble_world_body* body) {
  double sum = 0;
  for (uint32_t i = 0; i < body->vertex_count; ++i) sum += body->positions_single[3 * i + 2];
  return body->origin[2] + sum / body->vertex_count;
}

int main(int argc, char** argv) {
  const char* scene = argc > 1 ? argv[1] : "ball_drop";
  const int seconds = argc > 2 ? atoi(argv[2]) : 3;
  char message[1024];
  wobble_world* world = NULL;
  const wobble_world_options options = {
      .struct_size = sizeof options, .flags = WOBBLE_WORLD_SINGLE, .scene = scene, .threads = 1};
  if (wobble_world_load(&options, &world, message, sizeof message) != WOBBLE_WORLD_OK) {
    fprintf(stderr, "study: %s\n", message);
    return 2;
  }

  wobble_world_body body = {.struct_size = sizeof body};
  wobble_world_info info = {.struct_size = sizeof info};
  wobble_world_energy energy = {.struct_size = sizeof energy};
  for (int second = 0; second <= seconds; ++second) {
    Check(wobble_world_read_body(world, 0, &body), "body 0");
    Check(wobble_world_read_energy(world, 0, &energy), "energy");
    Check(wobble_world_read_info(world, &info), "info");
    printf("%4.1f s  %u bodies, %s at %.3f m, kinetic energy %.3f J, hash %016llx\n", info.time, info.body_count,
           body.name, FindHeight(&body), energy.kinetic, (unsigned long long)info.hash);
    const double up[3] = {0, 0, 20 * body.mass};  // N, on one vertex, through one tick
    const uint16_t vertex = 0;
    Check(wobble_world_push(world, body.body, 1, &vertex, up), "push");
    Check(wobble_world_step(world, 60, NULL), "step");
  }
  wobble_world_free(world);
  return 0;
}
