// RoundCoefficients (rounding.h) with records in lanes: what is serial for one record, since each choice changes the
// context of the next, runs for 16 or 32 records at once. Every lane has the operations of the plain loop in the same
// order, so it has the same bits.
//
// Everything is a template of the lanes: see product_kernel.h.
#pragma once

#include "protocol/codec/encoding/crowd_kernels.h"

namespace wobble::protocol {

// L: Floats, Ints, Unsigneds and Doubles of kLanes lanes (Doubles: two of half as many); GatherFloats, WidenBytes,
// RoundToInts, AddDoubles, Interleave, IsAny.
template <class L, std::size_t kGroups>
struct RoundingLoop {
  using F = typename L::Floats;
  using I = typename L::Ints;
  using U = typename L::Unsigneds;
  static constexpr std::size_t kLanes = L::kLanes;

  struct Group {
    U brief, lasting;  // Contexts::Sums
    typename L::Doubles error;
    F worth;
    F wanted[kLanes];
    I expected[kLanes];  // ExpectedContext: magnitude below, sums above
    I chosen[kLanes];
  };

  // Turns rows into columns: as many perfect shuffles as an index of a lane has bits.
  template <class V>
  static void Transpose(V* rows) {
    V other[kLanes];
    for (std::size_t bit = 1; bit < kLanes; bit *= 2) {
      for (std::size_t i = 0; i < kLanes / 2; ++i) L::Interleave(rows[i], rows[i + kLanes / 2], other + 2 * i);
      for (std::size_t i = 0; i < kLanes; ++i) rows[i] = other[i];
    }
  }

  // Numbers of a whole block, or of the last one and zeros.
  template <class V, class Number>
  static V Load(const Number* from, std::size_t count) {
    V lanes = {};
    if (count == kLanes) {
      __builtin_memcpy(&lanes, from, sizeof lanes);
    } else {
      for (std::size_t i = 0; i < count; ++i) lanes[i] = from[i];
    }
    return lanes;
  }

  static void Store(I numbers, std::size_t count, std::int32_t* to) {
    if (count == kLanes) {
      __builtin_memcpy(to, &numbers, sizeof numbers);
    } else {
      for (std::size_t i = 0; i < count; ++i) to[i] = numbers[i];
    }
  }

  static F LoadGains(const std::int8_t* gains, std::size_t count) {
    std::int8_t padded[kLanes] = {};
    if (count == kLanes) return __builtin_convertvector(L::WidenBytes(gains), F);
    for (std::size_t i = 0; i < count; ++i) padded[i] = gains[i];
    return __builtin_convertvector(L::WidenBytes(padded), F);
  }

  // The coefficients of a lane from `at` on, in steps, less the contact prediction: FindWanted.
  static F FindWanted(const RoundingLane& lane, F gains, std::size_t at, std::size_t count) {
    const F wanted = Load<F>(lane.coefficients + at, count) * lane.perStep;
    if (lane.along == nullptr) return wanted;
    F suggested = __builtin_convertvector(Load<I>(lane.along + at, count), F) * gains * lane.contactScale;
    const F most = F{} + 1048576.0F;
    suggested = suggested < -most ? -most : suggested > most ? most : suggested;
    return wanted - __builtin_convertvector(L::RoundToInts(suggested), F) / 16.0F;
  }

  // FindLogarithm plus 1016, for 1 … 2^31 − 1. A float's exponent and highest bits are it; the bit that is cleared
  // below the eight highest keeps the conversion from rounding up across a power of two.
  static I FindLogarithm(U x) {
    return (I)(L::ToFloats((I)(x & ~(x >> 8)))) >> 20;  // NOLINT: the bits of the floats
  }

  // What escapes cost beside the symbol: 2 · length + 1 bits.
  static F FindEscapeCost(I high) {
    const I isEscape = high >= 15;
    const F rest = __builtin_convertvector(high < 15 ? I{} + 1 : high - 14, F);
    const I length = ((I)rest >> 23) - 127;
    return isEscape ? __builtin_convertvector(2 * length + 1, F) : F{};
  }

  static void RoundOne(const RoundingLanes& task, Group& group, std::size_t k) {
    const I expected = group.expected[k];
    const I gain = FindLogarithm(group.brief) + FindLogarithm(group.lasting) - 2032 - (expected >> 16);
    I place = ((I)((U)expected << 16) >> 16) + (gain >> 1);
    place = place < 0 ? I{} : place;
    place = place > 107 ? I{} + 107 : place;

    const F zero = {};
    const F wanted = group.wanted[k] < zero ? -group.wanted[k] : group.wanted[k];
    const F most = F{} + 1048576.0F;
    const F rounded = wanted + 0.5F;
    const I nearest = __builtin_convertvector(most < rounded ? most : rounded, I);
    const I smaller = nearest > 0 ? nearest - 1 : nearest;
    I high = nearest, highOfSmaller = smaller;
    if (L::IsAny(place >= 75)) {                                // contexts with low bits
      const I low = place < 75 ? I{} : (place - 66) * 57 >> 9;  // a ninth
      high >>= low;
      highOfSmaller >>= low;
    }
    const I row = place << 4;
    const F costOfZero = L::GatherFloats(task.costs, row);
    // With a sign, which 0 does not have; but where one of these is 0, 0 itself is the third choice, and cheaper.
    F cost = L::GatherFloats(task.costs, row + (high < 15 ? high : I{} + 15)) + 1.0F;
    F costOfSmaller = L::GatherFloats(task.costs, row + (highOfSmaller < 15 ? highOfSmaller : I{} + 15)) + 1.0F;
    if (L::IsAny(high >= 15)) {
      cost += FindEscapeCost(high);
      costOfSmaller += FindEscapeCost(highOfSmaller);
    }
    const F nearestFloat = __builtin_convertvector(nearest, F), smallerFloat = __builtin_convertvector(smaller, F);
    const F error = wanted - nearestFloat, errorOfSmaller = wanted - smallerFloat;
    const F price = error * error + group.worth * cost;
    const F priceOfSmaller = errorOfSmaller * errorOfSmaller + group.worth * costOfSmaller;
    const F priceOfZero = wanted * wanted + group.worth * costOfZero;
    const I takesSmaller = priceOfSmaller < price;
    const F least = takesSmaller ? priceOfSmaller : price;
    const I takesZero = priceOfZero < least;
    const I magnitude = takesZero ? I{} : takesSmaller ? smaller : nearest;
    const F left = wanted - (takesZero ? zero : takesSmaller ? smallerFloat : nearestFloat);
    L::AddDoubles(left * left, group.error);

    const U value = (U)(magnitude < 1023 ? magnitude : I{} + 1023) << 12;
    group.brief += value + 512 - (group.brief >> 3);
    group.lasting += value + 128 - (group.lasting >> 5);
    group.chosen[k] = group.wanted[k] < zero ? -magnitude : magnitude;
  }

  static void Round(const RoundingLanes& task, RoundingLane* lanes, std::size_t count) {
    Group groups[kGroups];
    for (std::size_t g = 0; g < kGroups; ++g) {
      groups[g].brief = groups[g].lasting = U{} + 4096;
      groups[g].error = typename L::Doubles();
      for (std::size_t i = 0; i < kLanes; ++i) groups[g].worth[i] = FindLane(lanes, count, g, i).bitWorth;
    }
    for (std::size_t at = 0; at < task.count; at += kLanes) {
      const std::size_t size = task.count - at < kLanes ? task.count - at : kLanes;
      const F gains = LoadGains(task.gains + at, size);
      for (std::size_t g = 0; g < kGroups; ++g) {
        for (std::size_t i = 0; i < kLanes; ++i) {
          const RoundingLane& lane = FindLane(lanes, count, g, i);
          groups[g].wanted[i] = FindWanted(lane, gains, at, size);
          groups[g].expected[i] = Load<I>(static_cast<const std::int32_t*>(lane.expected) + at, size);
        }
        Transpose(groups[g].wanted);
        Transpose(groups[g].expected);
      }
      for (std::size_t k = 0; k < kLanes; ++k) {
        for (std::size_t g = 0; g < kGroups; ++g) RoundOne(task, groups[g], k);
      }
      for (std::size_t g = 0; g < kGroups; ++g) {
        Transpose(groups[g].chosen);
        for (std::size_t i = 0; i < kLanes && g * kLanes + i < count; ++i) {
          Store(groups[g].chosen[i], size, lanes[g * kLanes + i].chosen + at);
        }
      }
    }
    for (std::size_t i = 0; i < count; ++i) lanes[i].error = groups[i / kLanes].error.Read(i % kLanes);
  }

  // Lanes that are left over do what the first one does.
  static const RoundingLane& FindLane(const RoundingLane* lanes, std::size_t count, std::size_t group, std::size_t i) {
    const std::size_t lane = group * kLanes + i;
    return lanes[lane < count ? lane : 0];
  }
};

}  // namespace wobble::protocol
