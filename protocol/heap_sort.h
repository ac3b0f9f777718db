#pragma once

#include <algorithm>
#include <functional>

namespace wobble::protocol {

// Sorts as std::sort does, where isBefore is a total order. std::sort is up to 5 kB of WebAssembly for each type that
// it is compiled for, this a fifth of that; it takes about twice as long, and what is sorted here is sorted once.
template <typename Range, typename IsBefore = std::less<>>
void HeapSort(Range& range, IsBefore isBefore = {}) {
  std::make_heap(range.begin(), range.end(), isBefore);
  std::sort_heap(range.begin(), range.end(), isBefore);
}

}  // namespace wobble::protocol
