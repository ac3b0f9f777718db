// Ends a program with a clear message on a PC whose processor is older than x86-64-v3, which all else is compiled for:
// otherwise it would end by an illegal instruction. This file alone is compiled for every x86-64 processor and runs
// before the initialisation of all globals. The programs link it as an object, since nothing calls it.
#ifdef __x86_64__

#include <unistd.h>

namespace {

__attribute__((constructor(101))) void RequireProcessor() {
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("fma")) return;
  constexpr char kMessage[] =
      "This program needs a processor of level x86-64-v3 (AVX2, BMI2 and FMA; Intel Haswell of 2013, AMD Excavator of "
      "2015, or later); this processor lacks it.\n";
  [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  _exit(2);
}

}  // namespace

#endif
