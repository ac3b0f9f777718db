#include "client/terminal/hands.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wobble::terminal {
namespace {

using client::BodySample;
using protocol::Vector3;
using wire::TuneKind;

constexpr float kUsualReach = 3;      // m, when the scene gives none
constexpr float kCarryAhead = 1.1F;   // m in front of the player's body at which a held body is carried,
constexpr float kCarryAbove = 0.7F;   // m above it
constexpr float kBladeLength = 2.5F;  // m, ahead of the player's body
constexpr float kBladeHeight = 1.5F;  // m, up and down from the player's body
constexpr float kLift = 0.3F;         // of a push: upward part per forward part
constexpr float kStiffnessStep = 1.25F;
constexpr float kTimeStep = 0.8F;
constexpr float kTiltStep = 0.15F;  // rad
constexpr float kTimeSkip = 1;      // s that key 5 skips

const BodySample* FindOwn(std::span<const BodySample> samples, const client::Client& client) {
  for (const BodySample& sample : samples) {
    if (sample.body == client.Welcome().ownBody) return &sample;
  }
  return nullptr;
}

Vector3 FindForward(const Camera& camera) {
  const Direction ahead = camera.ToWorld(0, 1);
  return {ahead.x, ahead.y, 0};
}

struct Target {
  const BodySample* sample = nullptr;
  std::uint16_t vertex = 0;
};

// Finds the vertex nearest to a point ahead of the player's body, within the scene's reach; among other bodies for
// which `isWanted` holds.
template <class IsWanted>
Target FindTarget(const Vector3& own, const Vector3& ahead, float reach, std::span<const BodySample> samples,
                  std::uint32_t ownBody, IsWanted&& isWanted) {
  Target target;
  float least = std::numeric_limits<float>::infinity();
  for (const BodySample& sample : samples) {
    if (sample.body == ownBody || !isWanted(sample)) continue;
    for (std::size_t i = 0; i < sample.vertices.size(); ++i) {
      const float distance = Length(sample.vertices[i] - ahead);
      if (distance >= least || Length(sample.vertices[i] - own) > reach) continue;
      least = distance;
      target = {&sample, static_cast<std::uint16_t>(i)};
    }
  }
  return target;
}

float FindReach(const client::Client& client) {
  const float reach = client.Welcome().reach;
  return reach > 0 ? reach : kUsualReach;
}

bool IsAny(const BodySample&) { return true; }
// Only bodies without gas for certain.
bool IsCuttable(const BodySample& sample) { return sample.blueprint->open || sample.blueprint->faces.empty(); }

}  // namespace

void Hands::Take(char32_t key, const Camera& camera, std::span<const BodySample> samples, client::Client& client) {
  const BodySample* own = FindOwn(samples, client);
  if (own == nullptr) return;
  const Vector3 centre = own->pose.centroid;
  const Vector3 forward = FindForward(camera);
  const auto find = [&](auto&& isWanted) {
    return FindTarget(centre, centre + forward, FindReach(client), samples, own->body, isWanted);
  };
  if (key == U'g') {
    if (HoldsSomething()) return LetGo(client);
    const Target target = find(&IsAny);
    if (target.sample == nullptr) return;
    m_held.body = target.sample->body;
    m_held.vertex = target.vertex;
    Update(camera, samples, client);
  } else if (key == U'v') {
    const Target target = find(&IsAny);
    if (target.sample != nullptr) client.Push(target.sample->body, target.vertex, forward + Vector3{0, 0, kLift});
  } else if (key == U't') {
    const Target target = find(&IsCuttable);
    const Vector3 end = centre + forward * kBladeLength;
    const Vector3 up{0, 0, kBladeHeight};
    if (target.sample != nullptr) client.Cut(target.sample->body, centre, end + up, end - up);
  } else {
    Tune(key, client);
  }
}

void Hands::LetGo(client::Client& client) {
  m_held = {};
  client.SetHand({});
}

void Hands::Update(const Camera& camera, std::span<const BodySample> samples, client::Client& client) {
  if (!HoldsSomething()) return;
  const BodySample* own = FindOwn(samples, client);
  const bool isThere =
      std::any_of(samples.begin(), samples.end(), [&](const BodySample& each) { return each.body == m_held.body; });
  if (own == nullptr || !isThere) return LetGo(client);
  m_held.target = own->pose.centroid + FindForward(camera) * kCarryAhead + Vector3{0, 0, kCarryAbove};
  client.SetHand(m_held);
}

void Hands::Tune(char32_t key, client::Client& client) {
  const client::Tuning& now = client.ReadTuning();
  const auto scale = [&](TuneKind kind, float value, float least, float most) {
    client.Tune(kind, {std::clamp(value, least, most), 0, 0});
  };
  switch (key) {
    case U'1':
      return scale(TuneKind::Stiffness, now.stiffness / kStiffnessStep, 0.5F, 4);
    case U'2':
      return scale(TuneKind::Stiffness, now.stiffness * kStiffnessStep, 0.5F, 4);
    case U'3':
      return scale(TuneKind::TimeRate, now.timeRate * kTimeStep, 0.1F, 1);
    case U'4':
      return scale(TuneKind::TimeRate, now.timeRate / kTimeStep, 0.1F, 1);
    case U'5':
      return client.Tune(TuneKind::Jump, {kTimeSkip, 0, 0});
    case U'6':
    case U'7': {  // tilts about y; key 7 tilts back
      const float angle = key == U'6' ? kTiltStep : -kTiltStep;
      const Vector3 g = now.gravity;
      const float cosine = std::cos(angle), sine = std::sin(angle);
      return client.Tune(TuneKind::Gravity, {cosine * g.x - sine * g.z, g.y, sine * g.x + cosine * g.z});
    }
    default:
      return;
  }
}

std::vector<std::string> DescribeHandKeys(const client::Client& client) {
  const unsigned hands = client.Welcome().hands;
  const unsigned may = client.ReadTuning().may;
  std::vector<std::string> lines;
  if ((hands & protocol::kMayGrab) != 0) lines.emplace_back("G                grab the nearest body, release it");
  if ((hands & protocol::kMayPush) != 0) lines.emplace_back("V                push the nearest body");
  if ((hands & protocol::kMayCut) != 0) lines.emplace_back("T                cut cloth and springs ahead");
  if ((may & protocol::kMayTuneStiffness) != 0) lines.emplace_back("1 2              softer, stiffer");
  if ((may & protocol::kMayTuneTime) != 0) lines.emplace_back("3 4  5           slower, faster  skip a second");
  if ((may & protocol::kMayTuneGravity) != 0) lines.emplace_back("6 7              tilt gravity");
  return lines;
}

}  // namespace wobble::terminal
