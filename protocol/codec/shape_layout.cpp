#include "protocol/codec/shape_layout.h"

#include <algorithm>

namespace wobble::protocol {
namespace {

constexpr std::size_t kModes = 8;
// By usesBasis + 2 followsContact + 4 pressesOut.
constexpr std::array<Frequency, kModes> kModeFrequencies = {
    {{0, 64}, {64, 1900}, {1964, 32}, {1996, 1600}, {3596, 32}, {3628, 200}, {3828, 32}, {3860, 236}}};

// The grid is written as its distance from the usual one for a body of this size, from 4 coarser to 4 finer. The last
// symbol is for all other grids, which then follow as a number.
constexpr std::size_t kGrids = 10;
constexpr int kUsualGrid = 12;
constexpr std::array<Frequency, kGrids> kGridFrequencies = {{{0, 30},
                                                             {30, 60},
                                                             {90, 200},
                                                             {290, 700},
                                                             {990, 1500},
                                                             {2490, 1200},
                                                             {3690, 250},
                                                             {3940, 80},
                                                             {4020, 40},
                                                             {4060, 36}}};

template <std::size_t kCount>
std::size_t TakeSymbol(RangeDecoder& decoder, const std::array<Frequency, kCount>& frequencies) {
  const std::uint32_t place = decoder.Find();
  std::size_t symbol = kCount - 1;
  while (frequencies[symbol].start > place) --symbol;
  decoder.Take(frequencies[symbol].start, frequencies[symbol].size);
  return symbol;
}

}  // namespace

void WriteHead(RangeEncoder& encoder, float size, const ShapeHead& head) {
  const Frequency mode = kModeFrequencies[(head.mode.usesBasis ? 1U : 0U) + (head.mode.followsContact ? 2U : 0U) +
                                          (head.mode.pressesOut ? 4U : 0U)];
  encoder.Encode(mode.start, mode.size);
  const unsigned grid = head.pose.grid.grid;
  const int place = static_cast<int>(grid) - (kUsualGrid - FindExponent(size)) + 4;
  const bool isUsual = place >= 0 && place < static_cast<int>(kGrids) - 1;
  const Frequency frequency = kGridFrequencies[isUsual ? static_cast<std::size_t>(place) : kGrids - 1];
  encoder.Encode(frequency.start, frequency.size);
  if (!isUsual) encoder.EncodeBits(grid, 5);
  encoder.EncodeBits(head.stepIndex, 6);
  WritePose(encoder, head.pose);
}

DecodeResult ReadHead(RangeDecoder& decoder, float size, ShapeHead& head) {
  const std::size_t mode = TakeSymbol(decoder, kModeFrequencies);
  head.mode = {(mode & 1) != 0, (mode & 2) != 0, (mode & 4) != 0};
  if (head.mode.followsContact && !head.mode.usesBasis) return DecodeResult::kBadMode;
  const std::size_t place = TakeSymbol(decoder, kGridFrequencies);
  const int grid = place == kGrids - 1 ? static_cast<int>(decoder.DecodeBits(5))
                                       : static_cast<int>(place) - 4 + kUsualGrid - FindExponent(size);
  if (grid < 0 || grid > static_cast<int>(kFinestGrid)) return DecodeResult::kBadStep;
  head.stepIndex = decoder.DecodeBits(6);
  head.pose.grid = MakePoseGrid(static_cast<unsigned>(grid), size);
  if (!ReadPose(decoder, head.pose)) return DecodeResult::kBadPose;
  return decoder.Overran() ? DecodeResult::kTruncated : DecodeResult::kOk;
}

bool FindPressed(const PatchModel& model, std::span<const Side> sides, ContactScratch& contact) {
  auto& [pressed, moved, modes, along] = contact;
  pressed.assign(model.rest.begin(), model.rest.end());
  if (!PressOut(sides, pressed)) return false;
  const Basis& basis = *model.basis;
  const std::size_t count = model.rest.size();
  const std::size_t apart = basis.isScalar ? PadRow(count) : 1, stride = basis.isScalar ? 1 : 3;
  moved.assign(basis.isScalar ? 3 * apart : PadRow(3 * count), 0);
  const float unit = std::ldexp(1.0F, 12 - FindExponent(model.size));
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 way = (pressed[i] - model.rest[i]) * unit;
    std::size_t axis = 0;
    for (const float part : {way.x, way.y, way.z}) {
      moved[i * stride + axis++ * apart] =
          static_cast<std::int16_t>(std::nearbyint(std::clamp(part, -8191.0F, 8191.0F)));
    }
  }
  modes.resize(basis.Rows());
  std::size_t used = 0;
  const std::size_t axes = basis.isScalar ? 3 : 1;
  for (std::size_t k = 0; k < basis.Rows(); ++k) {
    bool follows = false;
    for (std::size_t axis = 0; axis < axes; ++axis) follows |= basis.gains[k * axes + axis] != 0;
    modes[used] = static_cast<std::uint16_t>(k);
    used += follows ? 1 : 0;
  }
  modes.resize(used);
  along.assign(3 * count, 0);
  return true;
}

std::size_t ListRows(const Basis& basis, const std::int16_t* numbers, std::int32_t* products,
                     std::array<ProductRow, 3>& rows) {
  if (!basis.isScalar) {
    rows[0] = {numbers, products, 1};
    return 1;
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    rows[axis] = {numbers + axis * PadRow(basis.vertices), products + axis, 3};
  return 3;
}

bool FindContact(const PatchModel& model, std::span<const Side> sides, ContactScratch& contact) {
  if (!FindPressed(model, sides, contact)) return false;
  std::array<ProductRow, 3> rows;
  const std::size_t count = ListRows(*model.basis, contact.moved.data(), contact.along.data(), rows);
  FindProducts(MakeProductTask(*model.basis, contact.modes), std::span(rows).first(count));
  return true;
}

}  // namespace wobble::protocol
