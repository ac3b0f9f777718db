// The numbers of contexts.h. The frequencies were counted on the coefficients of recorded play (balls of 42 and 162
// vertices, four of each, chased and pushed about; targets of 0.1, 0.25 and 0.5 %), with thirty coefficients of a
// Laplace distribution added to each table; the expectations are the mean magnitudes of a Laplace distribution behind a
// dead zone of 0.6 steps. STANDARD.md repeats both.
#include "protocol/contexts.h"

#include <cassert>

namespace wobble::protocol {
namespace {

// Of the levels kLowestLevel, kLowestLevel + 2, …
constexpr std::array<std::uint32_t, 61> kExpectations = {
    1, 1, 1, 1, 1, 1, 1, 2, 5, 14, 34, 73,
    138, 238, 379, 564, 798, 1084, 1427, 1835, 2317, 2886, 3557, 4349,
    5287, 6397, 7712, 9273, 11125, 13325, 15938, 19044, 22735, 27123, 32340, 38543,
    45919, 54689, 65117, 77519, 92266, 109803, 130658, 155459, 184951, 220024, 261732, 311332,
    370317, 440461, 523878, 623077, 741045, 881334, 1048166, 1246564, 1482501, 1763078, 2096743, 2493539,
    2965411};

using Counts = std::array<std::uint16_t, kMagnitudes>;
// A row a context, each adds up to kFrequencyTotal.
constexpr std::array<Counts, kContexts> kFrequencies = {{
    {4034, 48, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4020, 62, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4002, 80, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3978, 103, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3948, 132, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3909, 168, 6, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3861, 213, 9, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3799, 269, 15, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3723, 336, 23, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3628, 416, 37, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3512, 509, 57, 6, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3372, 613, 86, 12, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3207, 726, 126, 22, 4, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3015, 842, 180, 39, 8, 2, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {2798, 953, 249, 65, 17, 4, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {2558, 1049, 330, 104, 33, 10, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {2303, 1120, 418, 156, 58, 22, 8, 3, 1, 1, 1, 1, 1, 1, 1, 1},
    {2041, 1158, 504, 219, 96, 42, 18, 8, 3, 1, 1, 1, 1, 1, 1, 1},
    {1778, 1158, 579, 289, 145, 72, 36, 18, 9, 5, 2, 1, 1, 1, 1, 1},
    {1525, 1119, 632, 357, 201, 114, 64, 36, 20, 12, 7, 4, 2, 1, 1, 1},
    {1286, 1048, 657, 412, 258, 162, 102, 64, 40, 25, 16, 10, 6, 4, 2, 4},
    {1069, 952, 653, 447, 307, 210, 144, 99, 68, 46, 32, 22, 15, 10, 7, 15},
    {877, 841, 621, 459, 339, 251, 185, 137, 101, 75, 55, 41, 30, 22, 16, 46},
    {710, 725, 570, 448, 352, 277, 217, 171, 134, 105, 83, 65, 51, 40, 32, 116},
    {570, 612, 506, 418, 346, 286, 236, 195, 161, 133, 110, 91, 75, 62, 51, 244},
    {1135, 820, 593, 429, 310, 224, 162, 117, 85, 61, 44, 32, 23, 17, 12, 32},
    {907, 706, 550, 428, 333, 260, 202, 157, 123, 95, 74, 58, 45, 35, 27, 96},
    {719, 592, 488, 403, 332, 274, 226, 186, 154, 127, 104, 86, 71, 59, 48, 227},
    {1054, 782, 581, 432, 321, 238, 177, 131, 98, 73, 54, 40, 30, 22, 16, 47},
    {838, 667, 531, 422, 335, 267, 212, 169, 134, 107, 85, 67, 54, 43, 34, 131},
    {663, 556, 466, 391, 327, 274, 230, 193, 161, 135, 113, 95, 80, 67, 56, 289},
    {978, 744, 567, 431, 328, 250, 190, 145, 110, 84, 64, 49, 37, 28, 22, 69},
    {778, 629, 510, 413, 335, 271, 220, 178, 144, 117, 95, 77, 62, 51, 41, 175},
    {612, 521, 443, 377, 320, 273, 232, 197, 168, 143, 121, 103, 88, 75, 63, 360},
    {907, 706, 550, 428, 333, 260, 202, 157, 123, 95, 74, 58, 45, 35, 27, 96},
    {719, 592, 488, 403, 332, 274, 226, 186, 154, 127, 104, 86, 71, 59, 48, 227},}};

using Table = std::array<std::array<Frequency, kMagnitudes>, kContexts>;

constexpr Table MakeTable() {
  Table table{};
  for (std::size_t context = 0; context < kContexts; ++context) {
    std::uint16_t start = 0;
    for (std::size_t i = 0; i < kMagnitudes; ++i) {
      table[context][i] = {start, kFrequencies[context][i]};
      start = static_cast<std::uint16_t>(start + kFrequencies[context][i]);
    }
  }
  return table;
}
constexpr Table kTable = MakeTable();

constexpr bool AddsUp() {
  for (const auto& row : kTable) {
    if (row.back().start + row.back().size != kFrequencyTotal) return false;
  }
  return true;
}
static_assert(AddsUp());

}  // namespace

std::uint32_t FindExpectation(int level) {
  assert(level >= kLowestLevel && level <= kHighestLevel);
  return kExpectations[static_cast<std::size_t>(level - kLowestLevel) / 2];
}

const std::array<Frequency, kMagnitudes>& FindFrequencies(std::size_t context) { return kTable[context]; }

}  // namespace wobble::protocol
