// Shows a world from above and plays in it: arrow keys roll the own body, the orange one, and space lets it jump.
// `example [HOST:PORT [SECONDS]]`: with SECONDS it rolls in a circle by itself, and leaves then. Twice a second it
// prints where its body is.
#include <SDL.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <wobble.h>

enum { kVertices = 1 << 16, kIndices = 6 * kVertices };  // a larger world is not drawn
static float positions[3 * kVertices], normals[3 * kVertices];
static uint32_t indices[kIndices];
static SDL_Color colours[kVertices];

int main(int argc, char** argv) {
  const double seconds = argc > 2 ? atof(argv[2]) : HUGE_VAL;
  wobble_connect_options options = {.struct_size = sizeof options, .address = argc > 1 ? argv[1] : "127.0.0.1:7777"};
  wobble_client* client;
  const wobble_result result = wobble_connect(&options, 0, &client);
  if (result != WOBBLE_OK) return fprintf(stderr, "example: %s\n", wobble_describe(result)), 1;

  SDL_Init(SDL_INIT_VIDEO);
  SDL_Window* window = SDL_CreateWindow("wobble", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, 640, 480, 0);
  SDL_Renderer* renderer = SDL_CreateRenderer(window, -1, 0);
  SDL_SetRenderDrawBlendMode(renderer, SDL_BLENDMODE_BLEND);
  wobble_status status = {.struct_size = sizeof status};
  wobble_body own = {.struct_size = sizeof own};
  wobble_frame frame = {.struct_size = sizeof frame, .vertex_capacity = kVertices, .index_capacity = kIndices};
  frame.positions = positions, frame.normals = normals, frame.indices = indices;
  for (double printed = 0; status.state != WOBBLE_ENDED; SDL_Delay(15)) {
    const double now = (double)SDL_GetTicks64() / 1000;
    wobble_update(client, now);  // receives, answers and sends
    wobble_read_status(client, &status);
    if (now > seconds || SDL_QuitRequested()) wobble_leave(client, now);  // the loop goes on until that is answered
    const Uint8* keys = SDL_GetKeyboardState(NULL);
    wobble_input input = {.struct_size = sizeof input, .buttons = keys[SDL_SCANCODE_SPACE] ? WOBBLE_JUMP : 0};
    input.move_x = argc > 2 ? cosf((float)now) : (float)(keys[SDL_SCANCODE_RIGHT] - keys[SDL_SCANCODE_LEFT]);
    input.move_y = argc > 2 ? sinf((float)now) : (float)(keys[SDL_SCANCODE_UP] - keys[SDL_SCANCODE_DOWN]);
    wobble_set_input(client, &input);

    if (wobble_sample(client, now, &frame) != WOBBLE_OK) continue;
    for (uint32_t i = 0; wobble_read_body(client, i, &own) == WOBBLE_OK && own.body != status.own_body;) ++i;
    for (uint32_t v = 0; v < frame.vertex_count; ++v) {
      float *p = &positions[3 * v], up = fmaxf(normals[3 * v + 2], 0);  // what faces down is transparent
      p[0] = 320 + 40 * (p[0] - own.centroid[0]), p[1] = 240 - 40 * (p[1] - own.centroid[1]);  // pixels
      const Uint8 light = (Uint8)(60 + 195 * up), is_own = v - own.first_vertex < own.vertex_count;
      colours[v] = (SDL_Color){is_own ? light : light / 4, light / 2, is_own ? 0 : light, up > 0 ? 255 : 0};
    }
    SDL_SetRenderDrawColor(renderer, 20, 24, 32, 255);
    SDL_RenderClear(renderer);
    SDL_RenderGeometryRaw(renderer, NULL, positions, 12, colours, 4, NULL, 0, (int)frame.vertex_count, indices,
                          (int)frame.index_count, 4);
    SDL_RenderPresent(renderer);
    if (now < printed + 0.5) continue;
    printf("x %6.2f  y %6.2f  z %6.2f\n", own.centroid[0], own.centroid[1], own.centroid[2]);
    printed += 0.5;
  }
  if (status.ended_unasked) fprintf(stderr, "example: %s\n", status.reason);
  return wobble_destroy(client), SDL_Quit(), status.ended_unasked;
}
