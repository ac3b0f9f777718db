// The sizes of structs, as wobble.h's functions check them.
#pragma once

#include "client/wobble.h"
#include "protocol/c/structs.h"

namespace wobble::c {

template <>
inline constexpr std::size_t kFirstSize<wobble_status> = offsetof(wobble_status, description);
template <>
inline constexpr std::size_t kFirstSize<wobble_event> = offsetof(wobble_event, emote);

template <typename Struct>
[[nodiscard]] wobble_result CheckStruct(const Struct* given) {
  if (given == nullptr) return WOBBLE_NULL;
  return HasGoodSize(*given) ? WOBBLE_OK : WOBBLE_BAD_SIZE;
}

}  // namespace wobble::c
