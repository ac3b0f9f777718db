#include "protocol/acknowledgement.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace wobble::protocol {

ReceivedWindow::Arrival ReceivedWindow::Record(std::uint32_t sequence) {
  assert(sequence >= 1);
  if (sequence > m_newest) {
    const std::uint32_t ahead = sequence - m_newest;
    // The packet that was the newest becomes bit ahead-1; those between have not arrived.
    m_history = ahead < kAckHistory ? m_history << ahead : 0;
    if (m_newest != 0 && ahead <= kAckHistory) m_history |= std::uint64_t{1} << (ahead - 1);
    m_newest = sequence;
    return Arrival::kNew;
  }
  const std::uint32_t behind = m_newest - sequence;
  if (behind == 0) return Arrival::kDuplicate;
  if (behind > kAckHistory) return Arrival::kTooOld;
  const std::uint64_t bit = std::uint64_t{1} << (behind - 1);
  if ((m_history & bit) != 0) return Arrival::kDuplicate;
  m_history |= bit;
  return Arrival::kNew;
}

std::uint32_t SentWindow::RecordSent(double now) {
  Slot& slot = SlotOf(++m_newest);
  if (slot.sequence > m_judged) JudgeNext();  // the oldest one remembered is overwritten
  slot = {m_newest, false, now};
  return m_newest;
}

bool SentWindow::RecordAcknowledgement(std::uint32_t newest, std::uint64_t history, double now, Report& report) {
  // Bits below packet 1 name packets that do not exist.
  const bool beforeFirst = newest == 0 ? history != 0 : newest <= kAckHistory && history >> (newest - 1) != 0;
  if (newest > m_newest || beforeFirst) return false;
  report = {};
  for (std::uint32_t back = 0; back <= kAckHistory && back < newest; ++back) {
    if (back > 0 && (history >> (back - 1) & 1) == 0) continue;
    Slot& slot = SlotOf(newest - back);
    if (slot.sequence != newest - back || slot.acknowledged) continue;
    slot.acknowledged = true;
    ++report.acknowledged;
    m_acknowledged = std::max(m_acknowledged, slot.sentAt);
    if (back == 0) report.roundTrip = now - slot.sentAt;
  }
  return true;
}

void SentWindow::JudgeNext() {
  const bool hasArrived = SlotOf(++m_judged).acknowledged;
  m_lostInRow = hasArrived ? 0 : m_lostInRow + 1;
  m_lost += hasArrived ? 0 : 1;
  if (hasArrived) ++m_tally.arrived;
  if (!hasArrived && m_lostInRow <= kCountedInRow) ++m_tally.lost;
}

SentWindow::Tally SentWindow::Judge() {
  while (m_judged < m_newest && SlotOf(m_judged + 1).sentAt < m_acknowledged - kOvertaking) JudgeNext();
  return std::exchange(m_tally, {});
}

}  // namespace wobble::protocol
