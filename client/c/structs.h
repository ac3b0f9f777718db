// The sizes of structs, as wobble.h's functions check them.
#pragma once

#include "client/wobble.h"
#include "protocol/c/structs.h"

namespace wobble::c {

template <typename Struct>
[[nodiscard]] wobble_result CheckStruct(const Struct* given) {
  if (given == nullptr) return WOBBLE_NULL;
  return HasGoodSize(*given) ? WOBBLE_OK : WOBBLE_BAD_SIZE;
}

}  // namespace wobble::c
