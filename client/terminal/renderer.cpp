// Everything except planes goes through the rasteriser; planes are infinite and intersected with each sample's ray.
// Then every sample is lit once, and each pixel is the mean of its samples in linear light. That is the anti-aliasing;
// it makes 80 x 48 pixels enough to see a ball wobble.
//
// The light is a sun with half Lambert shading (a soft transition round a body), a sky above, the ground's reflection
// below, a glint and a brighter rim. Bodies have two shades by the octants of their rest shape, which makes rolling and
// bulging visible. The grid on surfaces is averaged exactly over a sample's extent on the surface, because it would
// otherwise flicker far away.
#include "client/terminal/renderer.h"

#include <algorithm>
#include <cmath>

namespace wobble::terminal {
namespace {

constexpr std::uint32_t kSurface = 0xFFFFFFFF;  // material of obstacles and grounds; bodies are 0, 1, ...

constexpr Light kSunLight{0.95F, 0.88F, 0.76F};
constexpr Light kSkyLight{0.34F, 0.42F, 0.58F};
constexpr Light kGroundLight{0.13F, 0.12F, 0.13F};
constexpr Light kHorizon{0.050F, 0.085F, 0.150F};
constexpr Light kZenith{0.006F, 0.012F, 0.034F};
constexpr Light kDepths{0.006F, 0.010F, 0.022F};
constexpr Light kFloor{0.055F, 0.078F, 0.118F};
constexpr Light kWall{0.120F, 0.105F, 0.150F};
constexpr Light kLine{0.20F, 0.29F, 0.40F};

constexpr float kLineWidth = 0.05F;      // metres; width of the lines one metre apart
constexpr float kWideLineWidth = 0.12F;  // metres; width of every fifth line
constexpr float kFogDistance = 45;       // least distance (metres) at which 1/e of the light passes the fog
constexpr float kFogReach = 2.5F;        // fog distance in units of the distance to the focus
constexpr float kShadowDepth = 0.85F;    // share of the sunlight that a shadow takes

// Upper bound of samples; a picture of so many costs a few milliseconds.
constexpr int kMaxSamples = 120'000;

// Bounds on what is drawn of a server's obstacles.
constexpr std::size_t kMaxPlanes = 16;
constexpr std::size_t kMaxBoxes = 512;
constexpr std::size_t kMaxCapsules = 64;  // and spheres

// Sides of a sphere or capsule around its axis, and rings from pole to pole (an even number). At 32 sides a silhouette
// is off by half a percent of the radius.
constexpr std::size_t kSides = 32;
constexpr std::size_t kRings = 16;

// Radius of a rod: a share of the mean spring length, within limits (metres), and at least so many samples.
constexpr float kRodShare = 0.05F;
constexpr float kThinRod = 0.01F;
constexpr float kThickRod = 0.06F;
constexpr float kLeastRod = 1.2F;
constexpr std::array<std::array<std::uint16_t, 3>, 2> kStripFaces{{{0, 1, 2}, {0, 2, 3}}};

Vector3 ToVector(const protocol::wire::Vec3& v) { return {v.x(), v.y(), v.z()}; }
Vector3 MultiplyEach(Vector3 a, Vector3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }

// Share of the interval x - width/2 .. x + width/2 that is covered by lines of width `line` at multiples of `spacing`,
// all in metres.
float FindCoverage(float x, float width, float line, float spacing) {
  const auto coveredUpTo = [&](float to) {
    const float cell = std::floor(to / spacing);
    return cell * line + std::min(to - cell * spacing, line);
  };
  const float begin = x + line / 2 - width / 2;
  return std::clamp((coveredUpTo(begin + width) - coveredUpTo(begin)) / width, 0.0F, 1.0F);
}

Light FindSky(Vector3 direction) {
  const float up = direction.z;
  if (up < 0) return Blend(kHorizon, kDepths, std::min(1.0F, -up * 2.5F));
  return Blend(kHorizon, kZenith, std::min(1.0F, std::sqrt(up) * 1.15F));
}

Light FindAmbient(Vector3 normal) { return Blend(kGroundLight, kSkyLight, normal.z * 0.5F + 0.5F); }

Light LightBody(const Sample& sample, Light colour, Vector3 toEye) {
  const Vector3 normal = Normalise(sample.normal);
  const float facing = std::max(0.0F, (Dot(normal, kToSun) + 0.3F) / 1.3F);
  const bool dark = ((sample.mark.x < 0) != (sample.mark.y < 0)) != (sample.mark.z < 0);
  const Light surface = colour * (dark ? 0.52F : 1.0F);
  Light light = Filter(surface, kSunLight * (facing * facing) + FindAmbient(normal));
  const float glint = std::max(0.0F, Dot(normal, Normalise(kToSun + toEye)));
  light = light + kSunLight * (0.45F * std::pow(glint, 48.0F));
  const float rim = 1 - std::max(0.0F, Dot(normal, toEye));
  return light + Filter(kSkyLight, colour) * (0.55F * rim * rim * rim);
}

}  // namespace

void Renderer::Draw(const World& world, const View& view, int width, int height, std::vector<Colour>& pixels) {
  int factor = 3;
  while (factor > 1 && width * height * factor * factor > kMaxSamples) --factor;
  m_samples.Reset(width * factor, height * factor);
  m_planes.clear();
  AddObstacles(world, view);
  const float reach = std::clamp(1.5F * Length(view.eye - world.focus), 8.0F, 40.0F);
  m_shadows.Reset(world.focus, reach);
  AddBodies(world.bodies, view);

  const Viewport viewport(m_samples.width, m_samples.height, view);
  m_lights.resize(m_samples.samples.size());
  for (int y = 0; y < m_samples.height; ++y) {
    for (int x = 0; x < m_samples.width; ++x) {
      m_lights[static_cast<std::size_t>(y * m_samples.width + x)] = LightSample(world, view, viewport, x, y);
    }
  }
  Reduce(factor, width, height, pixels);
}

void Renderer::AddObstacles(const World& world, const View& view) {
  using Kind = protocol::wire::ObstacleKind;
  std::size_t boxes = 0, capsules = 0;
  for (const protocol::wire::Obstacle& obstacle : world.obstacles) {
    const Vector3 a = ToVector(obstacle.a()), b = ToVector(obstacle.b());
    if (obstacle.kind() == Kind::Box) {
      if (boxes++ < kMaxBoxes) AddBox(a, b, view);
    } else if (obstacle.kind() == Kind::Sphere || obstacle.kind() == Kind::Capsule) {
      const Vector3 to = obstacle.kind() == Kind::Sphere ? a : b;
      if (capsules++ < kMaxCapsules) AddCapsule(a, to, obstacle.radius(), view);
    } else if (m_planes.size() < kMaxPlanes) {
      m_planes.push_back({Normalise(a), b.x});
    }
  }
  for (const client::Ground& ground : world.grounds) AddGround(ground, view);
  if (world.obstacles.empty() && world.grounds.empty()) m_planes.push_back({{0, 0, 1}, 0});
}

// Draws the front (counterclockwise) of a quadrangle.
void Renderer::DrawSurface(const View& view, const Corner& a, const Corner& b, const Corner& c, const Corner& d) {
  DrawTriangle(view, {a, b, c}, kSurface, m_samples);
  DrawTriangle(view, {a, c, d}, kSurface, m_samples);
}

// Builds rings of latitude about the axis; the equator stands twice, once at each end of the cylinder.
void Renderer::AddCapsule(Vector3 from, Vector3 to, float radius, const View& view) {
  const Vector3 axis = Normalise(to - from);
  const Vector3 across = Normalise(Cross(axis, std::abs(axis.x) < 0.7F ? Vector3{1, 0, 0} : Vector3{0, 1, 0}));
  const Vector3 along = Cross(axis, across);
  constexpr float kPi = 3.14159265F;
  m_corners.clear();
  for (std::size_t ring = 0; ring < kRings + 2; ++ring) {
    const bool upper = ring > kRings / 2;
    const float latitude = kPi * static_cast<float>(upper ? ring - 1 : ring) / kRings - kPi / 2;
    for (std::size_t side = 0; side < kSides; ++side) {
      const float longitude = 2 * kPi * static_cast<float>(side) / kSides;
      const Vector3 level = across * std::cos(longitude) + along * std::sin(longitude);
      const Vector3 normal = level * std::cos(latitude) + axis * std::sin(latitude);
      const Vector3 position = (upper ? to : from) + normal * radius;
      m_corners.push_back({position, normal, position});
    }
  }
  for (std::size_t ring = 0; ring <= kRings; ++ring) {
    for (std::size_t side = 0; side < kSides; ++side) {
      const std::size_t below = ring * kSides + side, beside = ring * kSides + (side + 1) % kSides;
      DrawSurface(view, m_corners[below], m_corners[beside], m_corners[beside + kSides], m_corners[below + kSides]);
    }
  }
}

void Renderer::AddGround(const client::Ground& ground, const View& view) {
  const auto height = [&](int column, int row) {
    return ground.heights[static_cast<std::size_t>(row * ground.columns + column)];
  };
  m_corners.clear();
  for (int row = 0; row < ground.rows; ++row) {
    for (int column = 0; column < ground.columns; ++column) {
      const int left = std::max(column - 1, 0), right = std::min(column + 1, ground.columns - 1);
      const int down = std::max(row - 1, 0), up = std::min(row + 1, ground.rows - 1);
      const float slopeX =
          (height(right, row) - height(left, row)) / (ground.cellSize * static_cast<float>(right - left));
      const float slopeY =
          (height(column, up) - height(column, down)) / (ground.cellSize * static_cast<float>(up - down));
      const Vector3 position{ground.corner.x + ground.cellSize * static_cast<float>(column),
                             ground.corner.y + ground.cellSize * static_cast<float>(row), height(column, row)};
      m_corners.push_back({position, Normalise({-slopeX, -slopeY, 1}), position});
    }
  }
  const auto columns = static_cast<std::size_t>(ground.columns);
  for (std::size_t i = 0; i + columns + 1 < m_corners.size(); ++i) {
    if (i % columns + 1 == columns) continue;
    DrawSurface(view, m_corners[i], m_corners[i + 1], m_corners[i + columns + 1], m_corners[i + columns]);
  }
}

void Renderer::AddBox(Vector3 centre, Vector3 half, const View& view) {
  constexpr std::array<Vector3, 3> kAxes{Vector3{1, 0, 0}, Vector3{0, 1, 0}, Vector3{0, 0, 1}};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      const Vector3 normal = kAxes[axis] * side;
      const Vector3 across = kAxes[(axis + 1) % 3] * side, along = kAxes[(axis + 2) % 3];
      std::array<Corner, 4> corners;
      constexpr std::array<std::array<float, 2>, 4> kTurns{{{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}};
      for (std::size_t i = 0; i < 4; ++i) {
        const Vector3 offset = normal + across * kTurns[i][0] + along * kTurns[i][1];
        const Vector3 position = centre + MultiplyEach(offset, half);
        corners[i] = {position, normal, position};
      }
      DrawSurface(view, corners[0], corners[1], corners[2], corners[3]);
    }
  }
}

void Renderer::AddBodies(std::span<const DrawnBody> bodies, const View& view) {
  std::uint32_t material = 0;
  for (const DrawnBody& body : bodies) {
    if (body.faces.empty()) {
      AddEdges(body, material, view);
    } else {
      AddFaces(body, material, view);
    }
    ++material;
  }
}

void Renderer::AddFaces(const DrawnBody& body, std::uint32_t material, const View& view) {
  ComputeNormals(body.vertices, body.faces, m_normals);
  for (const auto& face : body.faces) {
    std::array<Corner, 3> corners;
    for (std::size_t i = 0; i < 3; ++i) corners[i] = {body.vertices[face[i]], m_normals[face[i]], body.rest[face[i]]};
    DrawTriangle(view, corners, material, m_samples);
    if (!body.open) continue;
    for (Corner& corner : corners) corner.normal = corner.normal * -1;
    DrawTriangle(view, {corners[0], corners[2], corners[1]}, material, m_samples);
  }
  m_shadows.Add(body.vertices, body.faces);
}

// Draws springs as rods and masses as dots twice as thick; their size follows the springs' length and stays visible
// from afar.
void Renderer::AddEdges(const DrawnBody& body, std::uint32_t material, const View& view) {
  float length = 0;
  for (const auto& edge : body.edges) length += Length(body.rest[edge[1]] - body.rest[edge[0]]);
  if (!body.edges.empty()) length /= static_cast<float>(body.edges.size());
  const float rod = std::clamp(kRodShare * length, kThinRod, kThickRod);
  const float scale = Viewport(m_samples.width, m_samples.height, view).scale;
  const auto thicken = [&](float radius, Vector3 at) {
    return std::max(radius, kLeastRod * Dot(at - view.eye, view.forward) / scale);
  };
  for (const auto& edge : body.edges) {
    const Vector3 from = body.vertices[edge[0]], to = body.vertices[edge[1]];
    AddRod({from, {}, body.rest[edge[0]]}, {to, {}, body.rest[edge[1]]}, thicken(rod, (from + to) * 0.5F), material,
           view);
  }
  for (std::size_t i = 0; i < body.vertices.size(); ++i) {
    const Vector3 at = body.vertices[i];
    AddDot({at, {}, body.rest[i]}, 2 * thicken(rod, at), material, view);
  }
}

// Draws the visible half of a rod as a roof of two faces whose normals make it look round; in the shadow map as a
// strip.
void Renderer::AddRod(const Corner& from, const Corner& to, float radius, std::uint32_t material, const View& view) {
  const Vector3 axis = to.position - from.position;
  const auto findSide = [&](Vector3 towards) { return Normalise(Cross(axis, towards), {0, 0, 0}) * radius; };
  const Vector3 side = findSide(view.eye - from.position);
  const Vector3 ridge = Normalise(Cross(side, axis), {0, 0, 0}) * radius;
  const auto move = [](Corner corner, Vector3 by) {
    corner.position = corner.position + by;
    corner.normal = by;
    return corner;
  };
  for (const Vector3 edge : {side, side * -1}) {
    const std::array<Corner, 4> roof{move(from, edge), move(to, edge), move(to, ridge), move(from, ridge)};
    // Drawn in both orders; only one of them shows its front.
    DrawTriangle(view, {roof[0], roof[1], roof[2]}, material, m_samples);
    DrawTriangle(view, {roof[0], roof[2], roof[3]}, material, m_samples);
    DrawTriangle(view, {roof[0], roof[2], roof[1]}, material, m_samples);
    DrawTriangle(view, {roof[0], roof[3], roof[2]}, material, m_samples);
  }
  const Vector3 width = findSide(kToSun);
  const std::array<Vector3, 4> strip{from.position - width, from.position + width, to.position + width,
                                     to.position - width};
  m_shadows.Add(strip, kStripFaces);
}

void Renderer::AddDot(const Corner& at, float radius, std::uint32_t material, const View& view) {
  const Vector3 facing = Normalise(view.eye - at.position);
  const auto move = [&](Vector3 by) { return Corner{at.position + by * radius, by, at.mark}; };
  constexpr int kCorners = 8;
  const auto rim = [&](int corner) {
    const float angle = 2 * 3.14159265F * static_cast<float>(corner) / kCorners;
    return move(view.right * std::cos(angle) + view.up * std::sin(angle));
  };
  for (int i = 0; i < kCorners; ++i) DrawTriangle(view, {move(facing), rim(i), rim(i + 1)}, material, m_samples);
  const Vector3 across = Normalise(Cross(kToSun, {0, 1, 0})) * radius;
  const Vector3 along = Normalise(Cross(kToSun, across)) * radius;
  const std::array<Vector3, 4> square{at.position - across, at.position - along, at.position + across,
                                      at.position + along};
  m_shadows.Add(square, kStripFaces);
}

Light Renderer::LightSample(const World& world, const View& view, const Viewport& viewport, int x, int y) const {
  const Vector3 ray = viewport.FindRay(view, x, y);
  const Sample& sample = m_samples.At(x, y);
  float inverseDepth = sample.inverseDepth;
  const Plane* nearest = nullptr;
  for (const Plane& plane : m_planes) {
    const float slope = Dot(plane.normal, ray);
    const float height = Dot(plane.normal, view.eye) - plane.offset;
    if (slope >= 0 || height <= 0 || -slope / height <= inverseDepth) continue;
    inverseDepth = -slope / height;
    nearest = &plane;
  }
  const Vector3 direction = Normalise(ray);
  if (inverseDepth <= 0) return FindSky(direction);
  const float depth = 1 / inverseDepth;
  Light light;
  if (nearest != nullptr) {
    light = LightSurface(view.eye + ray * depth, nearest->normal, ray, view, viewport);
  } else if (sample.material == kSurface) {
    light = LightSurface(sample.mark, Normalise(sample.normal), ray, view, viewport);
  } else {
    light = LightBody(sample, world.bodies[sample.material].colour, direction * -1);
  }
  const float fog = std::max(kFogDistance, kFogReach * Length(view.eye - world.focus));
  const float far = depth * Length(ray) / fog;
  return Blend(FindSky({direction.x, direction.y, std::min(direction.z, 0.0F) * 0.2F}), light, std::exp(-far * far));
}

Light Renderer::LightSurface(Vector3 point, Vector3 normal, Vector3 ray, const View& view,
                             const Viewport& viewport) const {
  // Distance on the surface to the neighbouring samples beside and above.
  const float depth = Dot(point - view.eye, view.forward);
  const auto step = [&](Vector3 axis) {
    const Vector3 sideways = axis * (depth / viewport.scale);
    return sideways - ray * (Dot(sideways, normal) / std::min(Dot(ray, normal), -1e-4F));
  };
  const Vector3 right = step(view.right), up = step(view.up);
  const auto cover = [&](float Vector3::*axis) {
    const float extent = std::max(1e-4F, std::abs(right.*axis) + std::abs(up.*axis));
    const float thin = FindCoverage(point.*axis, extent, kLineWidth, 1);
    const float wide = FindCoverage(point.*axis, extent, kWideLineWidth, 5);
    return std::max(0.5F * thin, wide);
  };
  const bool level = std::abs(normal.z) > 0.7F;
  float lines = 0;
  if (level || std::abs(normal.y) > 0.7F) lines = std::max(lines, cover(&Vector3::x));
  if (level || std::abs(normal.y) <= 0.7F) lines = std::max(lines, cover(&Vector3::y));
  const float steep = std::clamp((0.8F - std::abs(normal.z)) * 5, 0.0F, 1.0F);
  const Light surface = Blend(Blend(kFloor, kWall, steep * steep * (3 - 2 * steep)), kLine, 0.6F * lines);
  const float sun = std::max(0.0F, Dot(normal, kToSun)) * (1 - kShadowDepth * m_shadows.FindShade(point));
  return Filter(surface, kSunLight * sun + FindAmbient(normal));
}

void Renderer::Reduce(int factor, int width, int height, std::vector<Colour>& pixels) const {
  pixels.resize(static_cast<std::size_t>(width * height));
  const float share = 1 / static_cast<float>(factor * factor);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      Light sum;
      for (int i = 0; i < factor * factor; ++i) {
        const int column = x * factor + i % factor, row = y * factor + i / factor;
        sum = sum + m_lights[static_cast<std::size_t>(row * m_samples.width + column)];
      }
      pixels[static_cast<std::size_t>(y * width + x)] = Show(sum * share);
    }
  }
}

}  // namespace wobble::terminal
