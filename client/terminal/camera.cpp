// The camera approaches its target values exponentially, so that it neither jumps nor depends on the frame rate. The
// focus on a body that starts again elsewhere is the exception: it is taken over at once.
//
// When following, the camera turns by itself towards the direction of motion, more slowly than a player would, and not
// for a while after the player has turned it: enough to look ahead, too little to cause dizziness when running to and
// fro.
#include "client/terminal/camera.h"

#include <algorithm>
#include <cmath>

namespace wobble::terminal {
namespace {

// Downward pitch (radians) and distance (metres) before tilt and zoom.
constexpr float kFollowPitch = 0.45F;
constexpr float kCirclePitch = 0.46F;
constexpr float kFollowDistance = 5.6F;
constexpr float kFollowHeight = 0.35F;  // metres of the focus above the body
constexpr float kLeastPitch = 0.05F;
constexpr float kMostPitch = 1.45F;
constexpr float kLeastZoom = 0.3F;
constexpr float kMostZoom = 4;

// Time constants (seconds): after each, 1/e of the way remains.
constexpr double kFollowLag = 0.12;
constexpr double kCircleLag = 1.0;
constexpr double kTurnLag = 0.12;
constexpr double kModeLag = 0.4;

constexpr float kCircleSpeed = 0.15F;  // rad/s
constexpr float kHeadingSpeed = 0.7F;  // rad/s at most
constexpr double kHeadingPause = 2;    // s after the player has turned the camera
constexpr float kWalkingSpeed = 4;     // m/s from which the camera follows the heading at full speed
constexpr float kRespawnDistance = 5;  // metres; no body moves so far between two pictures

float Approach(float from, float to, double seconds, double lag) {
  return from + (to - from) * static_cast<float>(1 - std::exp(-seconds / lag));
}

Vector3 FindMiddle(std::span<const Vector3> points) {
  Vector3 sum;
  for (const Vector3& point : points) sum = sum + point;
  return sum * (1 / static_cast<float>(std::max<std::size_t>(points.size(), 1)));
}

// Distance (metres) from which all points are in sight, except one that is far from all others.
float FindDistance(std::span<const Vector3> points, Vector3 middle) {
  float squares = 0, farthest = 0;
  for (const Vector3& point : points) {
    const float square = Dot(point - middle, point - middle);
    squares += square;
    farthest = std::max(farthest, square);
  }
  const float spread = std::sqrt(squares / static_cast<float>(std::max<std::size_t>(points.size(), 1)));
  return std::clamp(1.8F * std::min(std::sqrt(farthest), 2 * spread), 7.0F, 60.0F);
}

}  // namespace

void Camera::ChooseNextMode(bool hasBody) {
  switch (m_mode) {
    case CameraMode::kFollow:
      m_mode = CameraMode::kCircle;
      return;
    case CameraMode::kCircle:
      m_mode = CameraMode::kStand;
      return;
    case CameraMode::kStand:
      m_mode = hasBody ? CameraMode::kFollow : CameraMode::kCircle;
      return;
  }
}

void Camera::Turn(float angle) {
  m_yawAsked += angle;
  m_sinceTurn = 0;
}

void Camera::Tilt(float angle) {
  const float pitch = m_mode == CameraMode::kFollow ? kFollowPitch : kCirclePitch;
  m_tilt = std::clamp(m_tilt + angle, kLeastPitch - pitch, kMostPitch - pitch);
}

void Camera::Zoom(float factor) { m_zoom = std::clamp(m_zoom * factor, kLeastZoom, kMostZoom); }

void Camera::Update(double seconds, std::optional<Vector3> own, std::span<const Vector3> bodies) {
  const bool follows = m_mode == CameraMode::kFollow && own.has_value();
  const Vector3 before = m_focus;
  const Vector3 target = follows ? *own + Vector3{0, 0, kFollowHeight} : bodies.empty() ? m_focus : FindMiddle(bodies);
  const float distance = m_zoom * (follows          ? kFollowDistance
                                   : bodies.empty() ? m_distance / m_zoom
                                                    : FindDistance(bodies, target));
  const float pitch =
      std::clamp((m_mode == CameraMode::kFollow ? kFollowPitch : kCirclePitch) + m_tilt, kLeastPitch, kMostPitch);
  m_sinceTurn += seconds;

  if (!m_placed || (follows && Length(target - m_focus) > kRespawnDistance && m_sinceTurn > kModeLag)) {
    m_focus = target;
  } else {
    const double lag = follows ? kFollowLag : kCircleLag;
    m_focus = {Approach(m_focus.x, target.x, seconds, lag), Approach(m_focus.y, target.y, seconds, lag),
               Approach(m_focus.z, target.z, seconds, follows ? 2 * lag : lag)};
    if (follows) FollowHeading(seconds, m_focus - before);
  }
  m_distance = m_placed ? Approach(m_distance, distance, seconds, kModeLag) : distance;
  m_pitch = m_placed ? Approach(m_pitch, pitch, seconds, kModeLag) : pitch;
  m_placed = m_placed || own.has_value() || !bodies.empty();
  if (m_mode == CameraMode::kCircle) m_yawAsked += kCircleSpeed * static_cast<float>(seconds);
  m_yaw = Approach(m_yaw, m_yawAsked, seconds, kTurnLag);
}

void Camera::FollowHeading(double seconds, Vector3 moved) {
  if (m_sinceTurn < kHeadingPause || seconds <= 0) return;
  const float way = std::hypot(moved.x, moved.y);
  const float speed = way / static_cast<float>(seconds);
  if (way < 1e-6F || speed > 10 * kWalkingSpeed) return;
  const float sine = (std::cos(m_yawAsked) * moved.y - std::sin(m_yawAsked) * moved.x) / way;
  m_yawAsked += kHeadingSpeed * std::min(speed / kWalkingSpeed, 1.0F) * sine * static_cast<float>(seconds);
}

View Camera::MakeView() const {
  View view;
  const float level = std::cos(m_pitch);
  view.forward = {level * std::cos(m_yaw), level * std::sin(m_yaw), -std::sin(m_pitch)};
  view.right = {std::sin(m_yaw), -std::cos(m_yaw), 0};
  view.up = Cross(view.right, view.forward);
  view.eye = m_focus - view.forward * m_distance;
  return view;
}

Direction Camera::ToWorld(float right, float forward) const {
  const float x = std::cos(m_yaw), y = std::sin(m_yaw);
  return {right * y + forward * x, -right * x + forward * y};
}

}  // namespace wobble::terminal
