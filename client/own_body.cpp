// The lead grows by the velocity that inputs will have given the body by the time that the newest of them acts, less
// the one that its records show, and falls back to 0 in kLeadBlend. So it is continuous whatever the records do,
// follows every input at once, and leaves a body alone that no input accelerates.
//
// To show the body where it will be, at the records' velocity times the delay and so a diameter ahead at full speed,
// was measured in arena with six bots: its place was then right to 12 % of the radius in half of the frames, but to 100
// % in a tenth of them, because whatever it meets is known a delay later. What was shown jumped by up to a quarter of
// the radius in one frame of a hundred (records: a twentieth), and where it met a body it stood inside or before it
// until the records came. Turning the shape as well was not tried: it is flat where the record's body lies on the
// ground.
#include "client/own_body.h"

#include <algorithm>

#include "client/input_stream.h"

namespace wobble::client {
namespace {

using protocol::Vector3;

// As in the server's control.cpp.
constexpr float kSpeedBand = 0.25F;
// Of a step of FollowInputs.
constexpr double kStep = 1.0 / 60;
// A ball that rolls turns two fifths of what pushes it into its spin (a hollow sphere).
constexpr float kRollingGrip = 0.6F;
// For so long a body that answers to pushes otherwise is taken to go on so, s; and full pushes of this length, s, are
// what the assumption about it is worth.
constexpr float kGripMemory = 0.4F;
constexpr float kGripTrust = 0.02F;
constexpr float kMostGrip = 1.2F;
// How fast a lead leaves what it has met, s: a body would be pressed in by as much as it goes in this time.
constexpr float kGiveWayWithin = 0.04F;
constexpr double kLagSmoothing = 1.0 / 16;
// A longer lag than this says that the server has had no inputs, not how long they take.
constexpr double kLongestLag = 1;
// A body that is further from where it was than at this speed, m/s, and by as many metres more, has been put there.
constexpr float kBelievedSpeed = 20;
constexpr float kBelievedStep = 1;
// Metres that nobody sees.
constexpr float kNothing = 1e-4F;
// A pause of the program after which the lead begins anew.
constexpr double kLongestFrame = 0.25;
// Over which velocity and acceleration are taken from records: the time between two of them.
constexpr double kSpan = 1.0 / 30;
// A body that falls by more than this share of gravity is borne by nothing.
constexpr float kFalling = 0.5F;
constexpr float kLeastGravity = -1;

}  // namespace

Vector3 FindPush(const wire::Drive& drive, const Pressed& pressed, Vector3 velocity) {
  if (!(drive.speed() > 0) || (pressed.moveX == 0 && pressed.moveY == 0)) return {};
  const Vector3 missing{pressed.moveX * drive.speed() - velocity.x, pressed.moveY * drive.speed() - velocity.y, 0};
  const Vector3 share = missing * (1 / (kSpeedBand * drive.speed()));
  return share * (drive.acceleration() / std::max(1.0F, protocol::Length(share)));
}

Lead FollowInputs(const wire::Drive& drive, std::span<const Pressed> inputs, double from, double to, Vector3 velocity,
                  float grip, float gravity) {
  Lead lead{{}, velocity};
  std::size_t next = 0;
  while (next < inputs.size() && inputs[next].from <= from) ++next;
  Pressed held = next > 0 ? inputs[next - 1] : Pressed{};
  float rise = 0;  // upward velocity that a jump has given
  bool isUp = false;
  for (double time = from; time < to;) {
    double until = std::min(time + kStep, to);
    if (next < inputs.size()) until = std::min(until, inputs[next].from);
    const auto step = static_cast<float>(until - time);
    const Vector3 before = lead.velocity;
    const Vector3 push = FindPush(drive, held, before) * (isUp ? 1 : grip);
    lead.velocity = before + push * step;
    lead.way = lead.way + (before + lead.velocity) * (0.5F * step);
    if (isUp) {
      lead.way.z += rise * step + 0.5F * gravity * step * step;
      rise += gravity * step;
    }
    time = until;
    if (next < inputs.size() && inputs[next].from <= time && time < to) {
      held = inputs[next++];
      if (held.jumps) rise = drive.jump_speed(), isUp = true;
    }
  }
  lead.velocity.z += rise;
  return lead;
}

bool IsBorne(const Track& track, float gravity) {
  if (!(gravity < kLeastGravity)) return false;  // it cannot be told
  if (track.Newest().atRest) return true;
  const double newest = track.Newest().time;
  const auto find = [&](double before) { return track.FindCentroid(newest - before).z; };
  const auto square = static_cast<float>(kSpan * kSpan);
  return (find(0) - 2 * find(kSpan) + find(2 * kSpan)) / square > kFalling * gravity;
}

OwnBody::Base FindBase(const Track& track, double time, float gravity) {
  OwnBody::Base base{.time = time, .centroid = track.FindCentroid(time), .velocity = {}};
  base.isHeld = !track.Newest().atRest && time > track.Newest().time + kMaxExtrapolation;
  base.isBorne = IsBorne(track, gravity);
  const Vector3 way = track.FindCentroid(time + kSpan) - track.FindCentroid(time - kSpan);
  const Vector3 velocity = way * static_cast<float>(0.5 / kSpan);
  if (!base.isHeld && protocol::Length(velocity) < kBelievedSpeed) base.velocity = velocity;
  return base;
}

void OwnBody::Forget() {
  const double lag = m_lag;
  *this = {};
  m_lag = lag;
}

void OwnBody::NoteInput(const wire::Drive& drive, const Input& input, double now, bool isBorne) {
  const Vector3 asked =
      Vector3{static_cast<float>(RoundAxis(input.moveX)), static_cast<float>(RoundAxis(input.moveY)), 0} * (1.0F / 127);
  const Vector3 move = asked * (1 / std::max(1.0F, protocol::Length(asked)));
  Pressed pressed{.from = now, .moveX = move.x, .moveY = move.y};
  pressed.jumps = input.jump && !m_jumpHeld && isBorne && drive.jump_speed() > 0;
  m_jumpHeld = input.jump;
  const Pressed last = m_count > 0 ? m_inputs[m_count - 1] : Pressed{};
  if (!pressed.jumps && pressed.moveX == last.moveX && pressed.moveY == last.moveY) return;
  if (m_count == kRemembered) {
    std::move(m_inputs.begin() + 1, m_inputs.end(), m_inputs.begin());
    --m_count;
  }
  m_inputs[m_count++] = pressed;
}

double OwnBody::NoteLag(double lag) {
  const double known = std::clamp(lag, 0.0, kLongestLag);
  return m_lag = m_lag < 0 ? known : m_lag + (known - m_lag) * kLagSmoothing;
}

// How much of the pushes that records have in them their motion shows.
void OwnBody::NoteAnswer(const wire::Drive& drive, const Base& base) {
  const auto step = static_cast<float>(base.time - m_base.time);
  const float kept = kGripMemory / (kGripMemory + step);
  m_answered *= kept;
  m_pushed *= kept;
  const auto inputs = Inputs();
  std::size_t next = 0;
  while (next < inputs.size() && inputs[next].from <= m_base.time - m_lag) ++next;
  if (next == 0 || base.isHeld) return;
  const Vector3 push = FindPush(drive, inputs[next - 1], m_base.velocity);
  const float full = protocol::Dot(push, push) * step;
  m_pushed += full;
  m_answered += std::clamp(protocol::Dot(base.velocity - m_base.velocity, push), 0.0F, kMostGrip * full);
}

float OwnBody::FindGrip(const wire::Drive& drive, bool isBorne) const {
  const float trust = drive.acceleration() * drive.acceleration() * kGripTrust;
  if (!(trust > 0)) return 0;
  return (m_answered + trust * (isBorne ? kRollingGrip : 1)) / (m_pushed + trust);
}

Vector3 OwnBody::Follow(const wire::Drive& drive, const Base& base, double now, float gravity) {
  const double passed = now - m_now;
  const auto shown = static_cast<float>(base.time - m_base.time);
  const bool isCut =
      protocol::Length(base.centroid - m_base.centroid) > kBelievedSpeed * std::max(shown, 0.0F) + kBelievedStep;
  const bool follows = m_follows && passed < kLongestFrame && !isCut;
  if (follows && shown > 0) NoteAnswer(drive, base);
  m_now = std::max(now, m_now);
  m_step = 0;
  m_base = base;
  m_follows = true;
  if (!follows) return m_lead = {};
  if (passed <= 0) return m_lead;

  Lead ahead{{}, base.velocity};
  if (!base.isHeld && m_lag >= 0) {
    const double from = std::max(base.time - m_lag, now - kLongestLead);
    ahead = FollowInputs(drive, Inputs(), from, now, base.velocity, FindGrip(drive, base.isBorne), gravity);
  }
  const float step = m_step = static_cast<float>(passed);
  Vector3 way = ahead.velocity * step - base.velocity * shown;
  way.z = (ahead.velocity.z - base.velocity.z) * step;
  m_lead = m_lead + way;
  m_lead = m_lead - m_lead * (step / (step + kLeadBlend));
  // A body at rest stays exactly where it is.
  if (protocol::Length(m_lead) < kNothing && protocol::Length(way) == 0) m_lead = {};
  return m_lead;
}

Vector3 OwnBody::GiveWay(Vector3 lead) {
  return m_lead = m_lead + (lead - m_lead) * (m_step / (m_step + kGiveWayWithin));
}

}  // namespace wobble::client
