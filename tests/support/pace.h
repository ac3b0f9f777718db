// How long tests play under sanitizers, which make the engine some twenty times slower.
#pragma once

namespace wobble::test {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif

// Of what is played for its figures and not for the code that it passes through. Sanitizers look at memory, and the
// first part of it will do for them; what is said about the end is then for other builds to say.
[[nodiscard]] constexpr int Shorten(int whole) { return kIsSanitized ? (whole + 7) / 8 : whole; }

}  // namespace wobble::test
