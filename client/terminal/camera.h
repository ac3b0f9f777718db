// The position and direction from which the picture is taken: behind and above the player's body or a followed one, or
// on a circle round all bodies.
#pragma once

#include <optional>
#include <span>

#include "client/terminal/view.h"

namespace wobble::terminal {

enum class CameraMode {
  kFollow,  // follows the player's body or another one
  kCircle,  // circles slowly round the middle of the scene
  kStand,   // looks at the middle from one side, at rest
};

struct Direction {
  float x = 0;
  float y = 0;
};

class Camera {
 public:
  explicit Camera(CameraMode mode) : m_mode(mode) {}

  void Choose(CameraMode mode) { m_mode = mode; }
  // Skips kFollow when there is no body to follow.
  void ChooseNextMode(bool hasBody);
  [[nodiscard]] CameraMode Mode() const { return m_mode; }

  // Radians; positive to the left and upwards. The camera reaches the new direction within some tenths of a second.
  void Turn(float angle);
  void Tilt(float angle);
  // Multiplies the distance, within limits.
  void Zoom(float factor);

  // Moves the camera. seconds: since the last Update. own: centroid of the body to follow; bodies: centroids of all
  // bodies, metres.
  void Update(double seconds, std::optional<Vector3> own, std::span<const Vector3> bodies);

  [[nodiscard]] View MakeView() const;
  // The point that the camera looks at, metres.
  [[nodiscard]] Vector3 Focus() const { return m_focus; }
  // Converts a direction on the keys (right and forward as seen) to the world's x and y.
  [[nodiscard]] Direction ToWorld(float right, float forward) const;

 private:
  void FollowHeading(double seconds, Vector3 moved);

  CameraMode m_mode;
  bool m_placed = false;
  Vector3 m_focus;
  float m_yaw = 1.2F;  // of the direction of sight, radians from x towards y
  float m_pitch = 0.42F;
  float m_distance = 12;
  float m_yawAsked = 1.2F;
  float m_tilt = 0;  // radians added to the mode's own pitch
  float m_zoom = 1;
  double m_sinceTurn = 1e9;  // seconds since the player's last Turn
};

}  // namespace wobble::terminal
