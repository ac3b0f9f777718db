// Draws a lit picture of the world: bodies, obstacles, shadows and sky.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "client/client.h"
#include "client/terminal/colour.h"
#include "client/terminal/rasteriser.h"
#include "client/terminal/shadow.h"
#include "client/terminal/view.h"
#include "protocol/messages.h"

namespace wobble::terminal {

struct DrawnBody {
  std::span<const Vector3> vertices;  // in the world, metres
  std::span<const Vector3> rest;      // one per vertex, body frame; carries the pattern of the surface
  std::span<const std::array<std::uint16_t, 3>> faces;  // outward; indices of existing vertices
  Light colour;
  bool open = false;                                         // the backs of its faces are drawn as well
  std::span<const std::array<std::uint16_t, 2>> edges = {};  // drawn with all vertices, when there are no faces
};

struct World {
  std::span<const protocol::wire::Obstacle> obstacles;  // without obstacles and grounds the plane z = 0 is drawn
  std::span<const DrawnBody> bodies;
  Vector3 focus;  // centre of the shadow map
  std::span<const client::Ground> grounds = {};
};

class Renderer {
 public:
  // Draws width x height pixels, row by row from the top. Costs a few milliseconds (kMaxSamples in the source).
  void Draw(const World& world, const View& view, int width, int height, std::vector<Colour>& pixels);

 private:
  struct Plane {
    Vector3 normal;
    float offset = 0;
  };
  void AddObstacles(const World& world, const View& view);
  void AddBox(Vector3 centre, Vector3 half, const View& view);
  void AddCapsule(Vector3 from, Vector3 to, float radius, const View& view);
  void AddGround(const client::Ground& ground, const View& view);
  void DrawSurface(const View& view, const Corner& a, const Corner& b, const Corner& c, const Corner& d);
  void AddBodies(std::span<const DrawnBody> bodies, const View& view);
  void AddFaces(const DrawnBody& body, std::uint32_t material, const View& view);
  void AddEdges(const DrawnBody& body, std::uint32_t material, const View& view);
  void AddRod(const Corner& from, const Corner& to, float radius, std::uint32_t material, const View& view);
  void AddDot(const Corner& at, float radius, std::uint32_t material, const View& view);
  [[nodiscard]] Light LightSample(const World& world, const View& view, const Viewport& viewport, int x, int y) const;
  [[nodiscard]] Light LightSurface(Vector3 point, Vector3 normal, Vector3 ray, const View& view,
                                   const Viewport& viewport) const;
  void Reduce(int factor, int width, int height, std::vector<Colour>& pixels) const;

  // Buffers kept to save allocations.
  SampleGrid m_samples;
  ShadowMap m_shadows;
  std::vector<Plane> m_planes;
  std::vector<Vector3> m_normals;
  std::vector<Corner> m_corners;
  std::vector<Light> m_lights;
};

}  // namespace wobble::terminal
