// Counts and measurements of the quality of a client's link.
#pragma once

#include <cstdint>

#include "protocol/codec/shape_codec.h"
#include "protocol/messages.h"

namespace wobble::client {

// Counts and sums since the client was made, unless said otherwise. Seconds and bytes.
struct Statistics {
  std::uint64_t snapshots = 0;       // snapshot packets that arrived for the first time, whole
  std::uint64_t records = 0;         // records in them
  std::uint64_t duplicates = 0;      // snapshot packets that had arrived before, or are too old to tell
  std::uint64_t badSnapshots = 0;    // dropped whole: their head or the head of a record is broken
  std::uint64_t badRecords = 0;      // records that cannot be decoded, or of more bodies than are kept
  std::uint64_t unknownRecords = 0;  // of a blueprint that has not arrived yet; normal just after joining
  std::uint64_t badMessages = 0;     // control messages that failed verification or were out of place
  std::uint64_t bytesReceived = 0;   // payloads of all messages
  std::uint64_t framesSampled = 0;   // body samples shown
  std::uint64_t framesHeld = 0;      // body samples shown without a record in time
  std::uint64_t stalls = 0;          // times that a body began to be held
  std::uint64_t inputsSent = 0;
  double joinSeconds = 0;       // from the start to kPlaying; 0 before
  double snapshotAge = 0;       // SnapshotArrival::age of the last packet
  double snapshotInterval = 0;  // smoothed time between the ticks that arrive
  double inputToSnapshot = 0;   // last measured SnapshotArrival::inputToSnapshot
  double inputLag = 0;          // smoothed time of the world from an input to the tick that uses it, by estimate
  double timeRatio = 1;         // world time per wall time, as the server last published it
  double lossShare = 0;         // share of the last 64 snapshot packets that is missing
};

}  // namespace wobble::client
