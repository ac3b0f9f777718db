// The player's own body, shown ahead of the others by what inputs will do that no shown record has in it yet.
//
// Bodies are shown as they were some two tenths of a second before an input of now can act: a round trip, and the delay
// at which records are interpolated. The own body is moved by a lead: what its inputs of that time will do to its
// velocity, by the acceleration that the server gives it for them. Its shape and rotation stay those of the record, so
// that it is flat where it lies on the ground. Puffing up and stiffening change the shape, and are not led.
//
// All times are world time, seconds, and all lengths metres.
#pragma once

#include <array>
#include <cstddef>
#include <span>

#include "client/client.h"
#include "client/interpolator.h"
#include "protocol/geometry.h"
#include "protocol/messages.h"

namespace wobble::client {

// The longest time for which inputs lead the body: over a link that takes longer the newest of them do.
inline constexpr double kLongestLead = 0.4;
// A lead that no input renews falls to a third in this time.
inline constexpr float kLeadBlend = 0.25F;

// What the player has asked for from a moment on.
struct Pressed {
  double from = 0;
  float moveX = 0;  // as the server takes it: the length of both is at most 1
  float moveY = 0;
  bool jumps = false;  // a jump begins here, and the body had something to jump from
};

// Acceleration of a body's centre that an input asks for, m/s²: that of the server's control (PHYSICS.md), upright 0.
[[nodiscard]] protocol::Vector3 FindPush(const wire::Drive& drive, const Pressed& pressed, protocol::Vector3 velocity);

struct Lead {
  protocol::Vector3 way;       // further than the body was at the beginning
  protocol::Vector3 velocity;  // at the end
};
// What a body does from one moment to another that begins at this velocity and is moved by these inputs, ascending, and
// nothing else. grip: share of the push that arrives, see OwnBody::Base. Upright it moves by jumps alone; gravity:
// m/s², upright, brings it down again.
[[nodiscard]] Lead FollowInputs(const wire::Drive& drive, std::span<const Pressed> inputs, double from, double to,
                                protocol::Vector3 velocity, float grip, float gravity);

// Whether something bears a body, so that it could jump from there: of late it has not been falling freely. gravity:
// m/s², upright.
[[nodiscard]] bool IsBorne(const Track& track, float gravity);

class OwnBody {
 public:
  // Another scene, another body, or the same at another place: nothing of it is known.
  void Forget();

  // The input that holds from `now` on. isBorne: whether something bears the body, that it could jump from.
  void NoteInput(const wire::Drive& drive, const Input& input, double now, bool isBorne);
  // A snapshot has shown that an input acts so long after it is given. Returns how long they take, smoothed.
  double NoteLag(double lag);

  // The body as records show it.
  struct Base {
    double time = 0;  // the moment that is shown
    protocol::Vector3 centroid;
    protocol::Vector3 velocity;
    bool isBorne = false;  // by something under it
    bool isHeld = false;   // records are missing
  };
  // Moves the lead on to `now`, estimated, which never goes backwards, and returns it.
  [[nodiscard]] protocol::Vector3 Follow(const wire::Drive& drive, const Base& base, double now, float gravity);
  // Something is in the way of the lead that Follow has returned, and leaves it this one. Returns what is to be shown:
  // it comes there softly.
  [[nodiscard]] protocol::Vector3 GiveWay(protocol::Vector3 lead);

 private:
  void NoteAnswer(const wire::Drive& drive, const Base& base);
  [[nodiscard]] float FindGrip(const wire::Drive& drive, bool isBorne) const;
  [[nodiscard]] std::span<const Pressed> Inputs() const { return std::span(m_inputs).first(m_count); }

  // Changes of the input that are remembered. A stick changes it in every tick, so those of more than a second.
  static constexpr std::size_t kRemembered = 96;

  std::array<Pressed, kRemembered> m_inputs{};  // the first m_count, ascending
  std::size_t m_count = 0;
  bool m_jumpHeld = false;
  double m_lag = -1;  // unknown
  bool m_follows = false;
  double m_now = 0;      // of the lead
  float m_step = 0;      // of the last Follow
  Base m_base;           // and what it leads
  float m_answered = 0;  // recent pushes, (m/s²)² s, by how much of them the body's motion shows
  float m_pushed = 0;
  protocol::Vector3 m_lead;
};

// The body at the moment that is shown. The track must not be empty.
[[nodiscard]] OwnBody::Base FindBase(const Track& track, double time, float gravity);

}  // namespace wobble::client
