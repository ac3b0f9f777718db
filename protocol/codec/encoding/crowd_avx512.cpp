// The kernels of AVX-512. Compiled for it and run only on processors that have it.
#include "protocol/codec/encoding/crowd_wide.h"

namespace wobble::protocol {

CrowdKernels MakeCrowdKernels512() { return MakeWideKernels(); }

}  // namespace wobble::protocol
