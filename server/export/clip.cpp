// A body is cut into parts only where its vertices change, as in the workshop. Where faces or springs tear, the part
// gets another skin over the same vertices, so that the shapes of a curtain are found and stored once.
//
// A body at rest costs two keys and one shape, however long it rests.
#include "server/export/clip.h"

#include <algorithm>
#include <cmath>

#include "server/physics/model/rotation.h"

namespace wobble::exporting {
namespace {

using physics::Vector3d;

std::vector<std::uint16_t> ListVertices(const Skeleton& skeleton) {
  std::vector<std::uint16_t> vertices = skeleton.points;
  for (const physics::Face& face : skeleton.faces) vertices.insert(vertices.end(), face.begin(), face.end());
  for (const physics::EdgeEnds& line : skeleton.lines) vertices.insert(vertices.end(), line.begin(), line.end());
  std::ranges::sort(vertices);
  vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
  return vertices;
}

Vector3d FindMean(const std::vector<Vector3d>& positions) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& position : positions) sum += position;
  return sum / static_cast<double>(positions.size());
}

void AddVector(const Vector3d& vector, std::vector<float>& values) {
  for (const double each : vector) values.push_back(static_cast<float>(each));
}

// The rest shape of these vertices, as Part has it.
std::vector<float> FindRest(const physics::Blueprint& blueprint, const std::vector<std::uint16_t>& vertices) {
  const Vector3d mean = FindMean(blueprint.rest);
  std::vector<float> rest;
  for (const std::uint16_t vertex : vertices) AddVector(blueprint.rest[vertex] - mean, rest);
  return rest;
}

bool IsSame(const Key& a, const Key& b) {
  return a.shape == b.shape && a.centre == b.centre && a.rotation.coeffs() == b.rotation.coeffs();
}

// hasJumped: the body was put elsewhere since the last key, which then holds until just before this one. Otherwise a
// respawn would be a flight across the scene.
void Insert(Key key, bool hasJumped, std::vector<Key>& keys) {
  if (hasJumped) {
    Key held = keys.back();
    held.time = std::nextafter(key.time, 0.0F);
    if (held.time > keys.back().time) keys.push_back(held);
  }
  const bool goesOn = keys.size() > 1 && IsSame(keys.back(), key) && IsSame(keys[keys.size() - 2], key);
  if (goesOn) {
    keys.back().time = key.time;
  } else {
    keys.push_back(key);
  }
}

}  // namespace

void Clip::End(const Track& track) {
  Part& part = m_parts[track.part];
  part.span.to = part.skins.back().span.to = m_time;
}

void Clip::Redraw(const Frame& frame, const physics::Body& body, Track& track) {
  const physics::Blueprint& blueprint = frame.ground.World().BlueprintOf(body);
  Skin skin{.skeleton = FindSkeleton(blueprint, body), .isOpen = blueprint.topology.isOpen, .span = {.from = m_time}};
  std::vector<std::uint16_t> vertices = ListVertices(skin.skeleton);
  const bool isNew = track.lastTime < 0;
  if (!isNew) {
    Part& part = m_parts[track.part];
    if (std::ranges::includes(part.vertices, vertices) && part.rest == FindRest(blueprint, part.vertices)) {
      if (part.skins.back().skeleton == skin.skeleton) return;
      part.skins.back().span.to = m_time;
      part.skins.push_back(std::move(skin));
      return;
    }
    End(track);
  }
  track.part = m_parts.size();
  Part& part = m_parts.emplace_back();
  part.body = body.id;
  part.blueprint = blueprint.name;
  part.player = FindPlayerName(frame.ground, body.id);
  part.size = blueprint.size;
  part.rest = FindRest(blueprint, vertices);
  part.vertices = std::move(vertices);
  part.skins.push_back(std::move(skin));
  part.span.from = m_time;
}

void Clip::AddKey(const physics::Blueprint& blueprint, double speed, Track& track) {
  Part& part = m_parts[track.part];
  const Vector3d centre = FindMean(m_positions);
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < m_positions.size(); ++i) a += (m_positions[i] - centre) * blueprint.rest[i].transpose();
  track.rotation = physics::FindRotation(a, track.rotation);
  const Eigen::Matrix3d back = track.rotation.toRotationMatrix().transpose();
  m_shape.clear();
  for (const std::uint16_t vertex : part.vertices) AddVector(back * (m_positions[vertex] - centre), m_shape);
  for (std::size_t i = 0; i < m_shape.size(); ++i) m_shape[i] -= part.rest[i];
  const bool isKnown = !part.shapes.empty() && std::equal(m_shape.rbegin(), m_shape.rend(), part.shapes.rbegin());
  if (!isKnown) {
    part.shapes.insert(part.shapes.end(), m_shape.begin(), m_shape.end());
    m_bytes += m_shape.size() * sizeof(float);
  }
  const std::size_t shapes = m_shape.empty() ? 0 : part.shapes.size() / m_shape.size();
  const Key key{.time = m_time,
                .centre = centre.cast<float>(),
                .rotation = track.rotation.cast<float>(),
                .shape = static_cast<std::uint32_t>(shapes - 1)};
  const double reach = 2 * std::max(speed, track.speed) * (m_time - track.lastTime) + part.size;
  const bool hasJumped = !part.keys.empty() && (key.centre - part.keys.back().centre).norm() > reach;
  Insert(key, hasJumped, part.keys);
  track.speed = speed;
  track.lastTime = m_time;
}

void Clip::Follow(const Frame& frame, const physics::Body& body) {
  const physics::World& world = frame.ground.World();
  m_positions.clear();
  physics::VisitVertices(body, [&](std::size_t, const Vector3d& position) { m_positions.push_back(position); });
  // The engine resets such a body within a tick. Until then it stays as it was.
  if (!std::ranges::all_of(m_positions, [](const Vector3d& position) { return position.allFinite(); })) return;
  Track& track = m_tracks[body.id];
  const auto& torn = ReadTorn(body);
  const Look look{body.blueprint, world.Changes().slots[body.blueprint].revision,
                  std::ssize(torn) - std::ranges::count(torn, 0)};
  if (track.lastTime < 0 || look != track.look) Redraw(frame, body, track);
  track.look = look;
  const physics::Blueprint& blueprint = world.BlueprintOf(body);
  const double speed =
      std::visit([&](const auto& state) { return FindMeanVelocity(blueprint, state).norm(); }, body.state);
  AddKey(blueprint, speed, track);
}

void Clip::Add(const Frame& frame) {
  if (m_time < 0) m_begin = frame.time;
  const float before = m_time;
  m_time = static_cast<float>(frame.time - m_begin);
  m_isTooLong = m_isTooLong || m_time <= before;
  for (const physics::Body* body : frame.bodies) Follow(frame, *body);
  std::erase_if(m_tracks, [&](const auto& each) {
    const bool hasGone = std::ranges::none_of(frame.bodies, [&](const auto* body) { return body->id == each.first; });
    if (hasGone) End(each.second);
    return hasGone;
  });
}

}  // namespace wobble::exporting
