// The tables of contexts.h. The frequencies were counted on the coefficients of recorded play (two kinds of ball of 162
// vertices, four of each, chasing each other in a room; targets of 0.1, 0.25 and 0.5 % of the size), with thirty
// coefficients of a Laplace distribution added to each table. The expectations are the mean magnitudes of a Laplace
// distribution behind a dead zone of 0.6 steps. STANDARD.md repeats both.
#include "protocol/codec/contexts.h"

namespace wobble::protocol {

const std::array<std::uint32_t, 61> kExpectations = {
    1,      1,      1,       1,       1,       1,       1,       2,       5,      14,     34,     73,     138,
    238,    379,    564,     798,     1084,    1427,    1835,    2317,    2886,   3557,   4349,   5287,   6397,
    7712,   9273,   11125,   13325,   15938,   19044,   22735,   27123,   32340,  38543,  45919,  54689,  65117,
    77519,  92266,  109803,  130658,  155459,  184951,  220024,  261732,  311332, 370317, 440461, 523878, 623077,
    741045, 881334, 1048166, 1246564, 1482501, 1763078, 2096743, 2493539, 2965411};

namespace {

using Counts = std::array<std::uint16_t, kMagnitudes>;
// One row for each context; each adds up to kFrequencyTotal.
constexpr std::array<Counts, kContexts> kFrequencies = {{
    {4081, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4078, 4, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4076, 6, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4073, 9, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4069, 13, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4054, 28, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {4034, 48, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3989, 93, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3921, 161, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3808, 272, 3, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3665, 410, 8, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3494, 573, 16, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {3284, 767, 32, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {2999, 1016, 65, 4, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {2675, 1267, 131, 11, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {2294, 1494, 260, 32, 5, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {1916, 1608, 458, 85, 15, 4, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {1582, 1572, 682, 187, 48, 12, 4, 1, 1, 1, 1, 1, 1, 1, 1, 1},
    {1303, 1426, 853, 333, 116, 38, 13, 4, 2, 1, 1, 1, 1, 1, 1, 2},
    {1064, 1239, 928, 481, 220, 93, 38, 16, 6, 3, 1, 1, 1, 1, 1, 3},
    {869, 1052, 910, 576, 333, 179, 89, 43, 21, 10, 5, 3, 1, 1, 1, 3},
    {709, 875, 835, 611, 414, 268, 159, 92, 53, 30, 17, 10, 6, 4, 2, 11},
    {572, 708, 726, 584, 448, 337, 238, 160, 107, 67, 47, 32, 20, 14, 8, 28},
    {438, 559, 598, 520, 437, 364, 291, 221, 162, 126, 96, 71, 54, 37, 29, 93},
    {335, 425, 475, 432, 389, 350, 301, 253, 214, 179, 143, 121, 97, 78, 59, 245},
    {584, 720, 635, 528, 422, 329, 252, 176, 127, 89, 59, 41, 30, 20, 16, 68},
    {445, 568, 514, 461, 398, 338, 284, 237, 178, 144, 111, 85, 67, 49, 41, 176},
    {345, 443, 410, 388, 352, 320, 282, 246, 211, 177, 149, 126, 104, 84, 71, 388},
    {639, 639, 572, 489, 392, 312, 246, 205, 151, 115, 82, 59, 42, 33, 23, 97},
    {500, 519, 459, 408, 360, 313, 278, 248, 203, 166, 131, 101, 77, 60, 47, 226},
    {427, 424, 382, 344, 325, 288, 264, 233, 217, 187, 161, 132, 116, 93, 77, 426},
    {695, 617, 557, 459, 396, 314, 237, 176, 140, 100, 81, 65, 54, 42, 30, 133},
    {595, 540, 466, 403, 366, 305, 245, 200, 165, 138, 115, 98, 83, 64, 54, 259},
    {440, 416, 381, 346, 334, 305, 250, 210, 200, 179, 154, 128, 112, 101, 74, 466},
    {1011, 655, 508, 402, 316, 258, 204, 150, 117, 94, 71, 46, 40, 29, 25, 170},
    {611, 534, 437, 349, 282, 251, 219, 192, 163, 140, 114, 98, 86, 75, 62, 483},
}};

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

const std::array<Frequency, kMagnitudes>& FindFrequencies(std::size_t context) { return kTable[context]; }

void Contexts::Expect(std::span<const int> levels, std::span<ExpectedContext> expected) {
  Sums sums;
  for (std::size_t k = 0; k < levels.size(); ++k) {
    const std::uint32_t magnitude = FindExpectation(levels[k]);
    expected[k] = {
        .magnitude = static_cast<std::int16_t>(FindLogarithm(magnitude) - kUnit + kOffset),
        .sums = static_cast<std::int16_t>(FindLogarithm(sums.brief) + FindLogarithm(sums.lasting)),
    };
    sums.Add(magnitude);
  }
}

}  // namespace wobble::protocol
