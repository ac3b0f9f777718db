// A blueprint that changes while it is on its way is sent anew from its first byte. Finishing the old one first was
// rejected: no record can be decoded with it.
#include "server/snapshots/download.h"

#include <algorithm>

namespace wobble::server {

void Download::Begin(std::size_t grounds, std::size_t blueprints, std::uint8_t first,
                     std::span<const std::uint64_t> kept) {
  m_queue.clear();
  m_awaited.clear();
  m_stages = {};
  m_begunAt = m_sent;
  m_kept.assign(kept.begin(), kept.end());
  for (std::size_t i = 0; i < grounds; ++i) {
    m_queue.push_back({.kind = Item::Kind::kHeights, .number = static_cast<std::uint8_t>(i)});
  }
  if (first < blueprints) Renew(first);
  for (std::size_t slot = 0; slot < blueprints; ++slot) {
    if (slot != first) Renew(static_cast<std::uint8_t>(slot));
  }
}

void Download::Renew(std::uint8_t slot) {
  m_stages[slot] = Stage::kUnsent;
  std::erase_if(m_awaited, [&](const Awaited& each) { return each.slot == slot; });
  const auto queued = std::ranges::find_if(
      m_queue, [&](const Item& item) { return item.kind == Item::Kind::kBlueprint && item.number == slot; });
  if (queued != m_queue.end()) {
    queued->offset = 0;
  } else {
    m_queue.push_back({.kind = Item::Kind::kBlueprint, .number = slot});
  }
}

bool Download::TakeReport(std::uint32_t downloaded) {
  const auto behind = static_cast<std::int32_t>(m_sent - downloaded);
  if (behind < 0) return false;
  if (static_cast<std::int32_t>(downloaded - m_taken) > 0) m_taken = downloaded;
  while (!m_awaited.empty() && static_cast<std::int32_t>(m_taken - m_awaited.front().end) >= 0) {
    m_stages[m_awaited.front().slot] = Stage::kArrived;
    m_awaited.pop_front();
  }
  return true;
}

void Download::SendDue(std::span<const CapturedGround> grounds, const BlueprintCaptures& blueprints,
                       const SendFunction& send) {
  while (!m_queue.empty() && m_sent - m_taken < protocol::kDownloadWindowBytes) {
    Item& item = m_queue.front();
    if (item.kind == Item::Kind::kHeights) {
      SendRows(item, grounds[item.number], send);
    } else {
      SendChunk(item, blueprints[item.number], send);
    }
  }
}

void Download::SendRows(Item& item, const CapturedGround& ground, const SendFunction& send) {
  send(MakeRows(item.number, ground, item.offset));
  const std::size_t rows = std::min(CountRowsAtOnce(ground), ground.field.rows() - item.offset);
  item.offset += rows;
  m_sent += static_cast<std::uint32_t>(2 * rows * ground.field.columns());
  if (item.offset == ground.field.rows()) m_queue.pop_front();
}

void Download::SendChunk(Item& item, const CapturedBlueprint& blueprint, const SendFunction& send) {
  const std::size_t total = blueprint.message.size();
  const bool isKept = std::ranges::find(m_kept, blueprint.hash) != m_kept.end();
  if (isKept) item.offset = total;
  send(MakeChunk(item.number, blueprint, item.offset));
  const std::size_t bytes = std::min(protocol::kBlueprintChunkBytes, total - item.offset);
  item.offset += bytes;
  m_sent += bytes > 0 ? static_cast<std::uint32_t>(bytes) : protocol::kKeptPieceBytes;
  if (item.offset < total) return;
  m_stages[item.number] = Stage::kOnTheWay;
  m_awaited.push_back({.slot = item.number, .end = m_sent});
  m_queue.pop_front();
}

}  // namespace wobble::server
