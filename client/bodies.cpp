// A body has one track for each of its patches. All are made with the body's first record, so that the whole cost is
// known, and refused if need be, before anything is kept. Patches come in packets of their own and may be of different
// ticks; each is shown from its own track with its own pose, at the same moment, and the body's pose is that of the
// first. A patch without a record is shown in its rest shape.
//
// A body that changes its blueprint keeps its old form until the shown moment reaches the first record of the new one:
// the shown moment lies a tenth of a second behind, and a new track alone would jump ahead and wait there. Nothing is
// interpolated between forms, unless the rest shapes are the same (a torn cloth); then only the faces change.
#include "client/bodies.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace wobble::client {
namespace {

std::size_t CostOf(const Blueprint& blueprint) {
  return blueprint.rest.size() + kTrackCost * protocol::PatchCount(blueprint.rest.size());
}

bool HaveSameRest(const Blueprint& a, const Blueprint& b) {
  return std::equal(a.rest.begin(), a.rest.end(), b.rest.begin(), b.rest.end(),
                    [](protocol::Vector3 p, protocol::Vector3 q) { return p.x == q.x && p.y == q.y && p.z == q.z; });
}

}  // namespace

bool Bodies::Add(const protocol::RecordHead& head, const std::shared_ptr<const Blueprint>& blueprint,
                 std::uint32_t tick, double time, const protocol::Pose& pose, std::span<const protocol::Vector3> shape,
                 double playback) {
  assert(shape.size() == protocol::PatchSize(blueprint->rest.size(), head.patch) && !shape.empty());
  if (WasRemoved(head.body, tick)) return true;
  const auto known = m_bodies.find(head.body);
  if (known == m_bodies.end() && m_bodies.size() >= protocol::kMaxBodies) return false;
  Body& body = known == m_bodies.end() ? m_bodies[head.body] : known->second;
  if (body.forms.empty() || tick >= body.newestTick) {
    const bool isNew = body.forms.empty() || body.forms.back().blueprint != blueprint;
    if (isNew && !AppendForm(body, blueprint)) {
      if (body.forms.empty()) m_bodies.erase(head.body);
      return false;
    }
    if (isNew) body.forms.back().firstTick = tick, body.forms.back().firstTime = time;
    body.newestTick = tick;
    body.newestTime = time;
    body.rests = head.restTick != 0;
  }
  Form* form = FindForm(body, *blueprint, tick);
  if (form == nullptr) return true;
  if (tick < form->firstTick) form->firstTick = tick, form->firstTime = time;
  (*form->patches)[head.patch].Insert(time, head.restTick != 0, pose, shape, playback);
  DropUnseen(body, playback);
  return true;
}

Bodies::Form* Bodies::FindForm(Body& body, const Blueprint& blueprint, std::uint32_t tick) {
  std::size_t next = body.forms.size();
  while (next > 0 && body.forms[next - 1].firstTick > tick) --next;
  // The form at this tick, or the next one: its first record may come after a later one.
  if (next > 0 && body.forms[next - 1].blueprint.get() == &blueprint) return &body.forms[next - 1];
  if (next < body.forms.size() && body.forms[next].blueprint.get() == &blueprint) return &body.forms[next];
  return nullptr;
}

bool Bodies::AppendForm(Body& body, const std::shared_ptr<const Blueprint>& blueprint) {
  Form form;
  form.blueprint = blueprint;
  if (!body.forms.empty() && HaveSameRest(*body.forms.back().blueprint, *blueprint)) {
    form.patches = body.forms.back().patches;
  } else {
    if (m_tracked + CostOf(*blueprint) > kMaxTrackedVertices) return false;
    m_tracked += CostOf(*blueprint);
    form.patches = std::make_shared<std::vector<Track>>(protocol::PatchCount(blueprint->rest.size()),
                                                        Track(blueprint->size, m_curve));
  }
  if (body.forms.size() == kMaxForms) DropOldestForm(body);
  body.forms.push_back(std::move(form));
  return true;
}

void Bodies::DropOldestForm(Body& body) {
  if (body.forms.front().patches.use_count() == 1) m_tracked -= CostOf(*body.forms.front().blueprint);
  body.forms.erase(body.forms.begin());
}

// Drops forms that the shown moment has passed.
void Bodies::DropUnseen(Body& body, double playback) {
  while (body.forms.size() > 1 && body.forms[1].firstTime <= playback && !body.forms[1].patches->front().Empty()) {
    DropOldestForm(body);
  }
}

void Bodies::Remove(std::uint32_t body, std::uint32_t tick) {
  m_removals[m_nextRemoval] = {body, tick};
  m_nextRemoval = (m_nextRemoval + 1) % m_removals.size();
  const auto known = m_bodies.find(body);
  if (known != m_bodies.end() && known->second.newestTick <= tick) Erase(known);
}

bool Bodies::WasRemoved(std::uint32_t body, std::uint32_t tick) const {
  return std::any_of(m_removals.begin(), m_removals.end(),
                     [&](const Removal& removal) { return removal.body == body && tick <= removal.tick; });
}

Bodies::BodyMap::iterator Bodies::Erase(BodyMap::iterator body) {
  while (!body->second.forms.empty()) DropOldestForm(body->second);
  return m_bodies.erase(body);
}

void Bodies::Forget(double olderThan) {
  for (auto body = m_bodies.begin(); body != m_bodies.end();) {
    const bool isForgotten = !body->second.rests && body->second.newestTime < olderThan;
    body = isForgotten ? Erase(body) : std::next(body);
  }
}

void Bodies::Sample(double time, double newest, Detail detail, std::vector<BodySample>& samples,
                    Statistics& statistics) {
  std::size_t count = 0;
  for (auto& [number, body] : m_bodies) {
    const Form& form = ChooseForm(body, time);
    if (form.patches->front().Empty()) continue;  // no pose yet
    if (samples.size() == count) samples.emplace_back();
    BodySample& sample = samples[count++];
    sample.body = number;
    SampleBody(form, time, newest, detail, sample);
    ++statistics.framesSampled;
    if (sample.held) ++statistics.framesHeld;
    if (sample.held && !body.wasHeld) ++statistics.stalls;
    body.wasHeld = sample.held;
  }
  samples.resize(count);
}

const Track* Bodies::FindTrack(std::uint32_t body, double time) const {
  const auto known = m_bodies.find(body);
  if (known == m_bodies.end()) return nullptr;
  const Track& track = ChooseForm(known->second, time).patches->front();
  return track.Empty() ? nullptr : &track;
}

// The newest form that has begun and has a pose.
const Bodies::Form& Bodies::ChooseForm(const Body& body, double time) {
  std::size_t chosen = body.forms.size() - 1;
  while (chosen > 0 && (body.forms[chosen].firstTime > time || body.forms[chosen].patches->front().Empty())) --chosen;
  return body.forms[chosen];
}

void Bodies::SampleBody(const Form& form, double time, double newest, Detail detail, BodySample& sample) {
  if (sample.blueprint != form.blueprint) sample.blueprint = form.blueprint;
  sample.vertices.clear();
  sample.lead = {};
  sample.age = 0;
  sample.held = false;
  for (std::size_t patch = 0; patch < form.patches->size(); ++patch) {
    const Track& track = (*form.patches)[patch];
    if (track.Empty()) {
      if (detail == Detail::kPosesOnly) continue;
      const auto rest =
          std::span(form.blueprint->rest)
              .subspan(patch * protocol::kMaxPatchVertices, protocol::PatchSize(form.blueprint->rest.size(), patch));
      for (const protocol::Vector3& point : rest) sample.vertices.push_back(protocol::Transform(sample.pose, point));
      continue;
    }
    const Moment moment = track.FindMoment(time);
    const protocol::Pose pose = BlendPose(moment);
    if (patch == 0) sample.pose = pose;
    if (detail == Detail::kVertices) AppendVertices(moment, pose, sample.vertices);
    const TrackSample& last = *moment.samples[moment.count - 1];
    if (!last.atRest) sample.age = std::max(sample.age, newest - last.time);
    sample.held = sample.held || moment.held;
  }
}

}  // namespace wobble::client
