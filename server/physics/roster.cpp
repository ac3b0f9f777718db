// A list, not a mark in each body: to read a mark would cost a cache line for every sleeping body.
#include "server/physics/roster.h"

#include <algorithm>
#include <bit>

namespace wobble::physics {

// Makes room for all bodies here, so that falling asleep and waking in a tick do not allocate.
void Roster::Add() {
  m_woken.push_back(m_count++);
  const std::size_t room = std::bit_ceil(std::size_t{m_count});
  m_awake.reserve(room);
  m_woken.reserve(room);
  m_sleepers.Reserve(room);
}

void Roster::Remove(std::uint32_t body, bool asleep) {
  if (asleep) {
    m_sleepers.Remove(body);
  } else {
    FindAwake();
    m_awake.erase(std::lower_bound(m_awake.begin(), m_awake.end(), body));
  }
  m_sleepers.Renumber(body);
  for (auto* list : {&m_awake, &m_woken}) {
    for (std::uint32_t& other : *list) other -= other > body ? 1 : 0;
  }
  --m_count;
}

void Roster::Wake(std::uint32_t body) {
  m_sleepers.Remove(body);
  m_woken.push_back(body);
  ++m_wakes;
}

void Roster::LetSleep(std::span<const std::uint32_t> bodies, std::span<const Box> boxes) {
  FindAwake();
  auto next = bodies.begin();
  std::erase_if(m_awake, [&](std::uint32_t body) {
    if (next == bodies.end() || *next != body) return false;
    ++next;
    return true;
  });
  for (const std::uint32_t body : bodies) m_sleepers.Add(body, boxes[body]);
}

// Merges the two lists, which both ascend, from behind, where there is room.
std::span<const std::uint32_t> Roster::FindAwake() {
  if (m_woken.empty()) return m_awake;
  std::sort(m_woken.begin(), m_woken.end());
  std::size_t old = m_awake.size();
  m_awake.resize(old + m_woken.size());
  for (std::size_t to = m_awake.size(); !m_woken.empty();) {
    if (old > 0 && m_awake[old - 1] > m_woken.back()) {
      m_awake[--to] = m_awake[--old];
    } else {
      m_awake[--to] = m_woken.back();
      m_woken.pop_back();
    }
  }
  return m_awake;
}

}  // namespace wobble::physics
