// The length of tests under sanitizers, which make the engine some twenty times slower.
#pragma once

namespace wobble::test {

#ifdef WOBBLE_SANITIZED
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif

// Shortens a run that is played for its figures rather than for the code it covers. Sanitizers check memory, and the
// first part is enough for that; checks of the final state are left to other builds.
[[nodiscard]] constexpr int Shorten(int whole) { return kIsSanitized ? (whole + 7) / 8 : whole; }

}  // namespace wobble::test
