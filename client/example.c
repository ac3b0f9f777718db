// Shows a world from above and plays in it: the arrow keys roll the own body, the orange one, and space lets it jump.
//
//   example HOST:PORT [SECONDS [PICTURE.bmp]]
//
// With SECONDS it rolls in a circle by itself and leaves then. Twice a second it prints where its body is.
#include <SDL.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <wobble.h>

int main(int argc, char** argv) {
  const double seconds = argc > 2 ? atof(argv[2]) : 1e9;
  if (SDL_Init(SDL_INIT_VIDEO) != 0) return 1;
  SDL_Window* window = SDL_CreateWindow("wobble", SDL_WINDOWPOS_CENTERED, SDL_WINDOWPOS_CENTERED, 960, 640, 0);
  SDL_Renderer* renderer = SDL_CreateRenderer(window, -1, 0);

  wobble_client* client;
  const wobble_connect_options options = {.struct_size = sizeof options, .address = argc > 1 ? argv[1] : "[::1]:7777"};
  const wobble_result result = wobble_connect(&options, 0, &client);
  if (result != WOBBLE_OK) return fprintf(stderr, "example: %s\n", wobble_describe(result)), 1;

  wobble_status status = {.struct_size = sizeof status};
  wobble_body own = {.struct_size = sizeof own};
  wobble_frame frame = {.struct_size = sizeof frame};
  SDL_Color* colours = NULL;
  for (unsigned n = 1; status.state != WOBBLE_ENDED; ++n) {
    const double now = SDL_GetTicks64() / 1000.0;
    for (SDL_Event event; SDL_PollEvent(&event);) {
      if (event.type == SDL_QUIT) wobble_leave(client, now);
    }
    if (now > seconds) wobble_leave(client, now);  // more than once does no harm
    const Uint8* keys = SDL_GetKeyboardState(NULL);
    wobble_input input = {.struct_size = sizeof input, .buttons = keys[SDL_SCANCODE_SPACE] ? WOBBLE_JUMP : 0};
    input.move_x = argc > 2 ? cosf((float)now) : keys[SDL_SCANCODE_RIGHT] - keys[SDL_SCANCODE_LEFT];
    input.move_y = argc > 2 ? sinf((float)now) : keys[SDL_SCANCODE_UP] - keys[SDL_SCANCODE_DOWN];
    wobble_set_input(client, &input);
    wobble_update(client, now);
    wobble_read_status(client, &status);

    while (wobble_sample(client, now, &frame) == WOBBLE_TOO_SMALL) {
      frame.positions = realloc(frame.positions, 12 * (frame.vertex_capacity = frame.vertex_count));
      frame.normals = realloc(frame.normals, 12 * frame.vertex_capacity);
      frame.indices = realloc(frame.indices, 4 * (frame.index_capacity = frame.index_count));
      colours = realloc(colours, frame.vertex_capacity * sizeof *colours);
    }
    for (uint32_t i = 0; wobble_read_body(client, i, &own) == WOBBLE_OK && own.body != status.own_body;) ++i;
    for (uint32_t v = 0; v < frame.vertex_count; ++v) {
      frame.positions[3 * v] = 480 + 50 * (frame.positions[3 * v] - own.centroid[0]);  // pixels, 50 a metre
      frame.positions[3 * v + 1] = 320 - 50 * (frame.positions[3 * v + 1] - own.centroid[1]);
      const Uint8 light = (Uint8)(255 * fmaxf(frame.normals[3 * v + 2], 0)), isOwn = v - own.first_vertex < own.vertex_count;
      colours[v] = (SDL_Color){isOwn ? light : light / 4, light / 2, isOwn ? 0 : light, light > 0 ? 255 : 0};
    }
    SDL_SetRenderDrawColor(renderer, 20, 24, 32, 255);
    SDL_RenderClear(renderer);
    SDL_SetRenderDrawBlendMode(renderer, SDL_BLENDMODE_BLEND);  // what faces down is transparent
    SDL_RenderGeometryRaw(...);
    SDL_RenderPresent(renderer);
    SDL_Delay(16);
  }
}
