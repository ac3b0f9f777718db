// What a client knows about how well it is served.
#pragma once

#include <cstdint>

#include "protocol/messages.h"
#include "protocol/shape_codec.h"

namespace wobble::client {

// Counts and sums since the client was made, unless said otherwise. Seconds and bytes.
struct Statistics {
  std::uint64_t snapshots = 0;       // snapshot packets that arrived for the first time, whole
  std::uint64_t records = 0;         // bodies' records in them
  std::uint64_t duplicates = 0;      // snapshot packets that had arrived before, or are too old to tell
  std::uint64_t badSnapshots = 0;    // dropped whole because their head or a record's frame is broken
  std::uint64_t badRecords = 0;      // records whose payload could not be decoded, or one body more than is kept
  std::uint64_t unknownRecords = 0;  // of a blueprint not here yet; normal just after joining
  std::uint64_t badMessages = 0;     // control messages that failed verification or were out of place
  std::uint64_t bytesReceived = 0;   // payloads of all messages
  std::uint64_t framesSampled = 0;   // body samples shown
  std::uint64_t framesHeld = 0;      // of these, with nothing newer in time
  std::uint64_t stalls = 0;          // times that a body began to be held
  std::uint64_t inputsSent = 0;
  double joinSeconds = 0;       // from the start to kPlaying; 0 before
  double snapshotAge = 0;       // of the newest snapshot, last arrival: arrival minus its tick's time, s
  double snapshotInterval = 0;  // mean spacing of arriving ticks, s
  double inputToSnapshot = 0;   // last measured: from sending an input to a snapshot whose world has used it, s
  double timeRatio = 1;         // as the server last published it
  double lossShare = 0;         // snapshot packets missing of the last 64
};

}  // namespace wobble::client
