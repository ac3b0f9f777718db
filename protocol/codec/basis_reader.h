// Reads a basis and completes it, at once or step by step.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "protocol/codec/basis.h"
#include "protocol/codec/basis_completion.h"

namespace wobble::protocol {

// Any bytes are safe. A full basis of 486 rows with 60 modes takes 45 million multiplications in about 4,500 steps.
class BasisReader {
 public:
  // vertices: that the basis must be for.
  BasisReader(std::span<const std::uint8_t> bytes, std::size_t vertices);

  // Does the next part of the work, at most 0.6 million multiplications each with an addition, and returns about how
  // many; 0 when all is done.
  std::size_t Step();
  // Does what is left. nullptr when the bytes are no such basis. To be called once.
  [[nodiscard]] std::shared_ptr<const Basis> Take();

 private:
  //   kCosines                                                              -> kDone
  //   kGiven -> kReflections -> (kTurn -> kPanels -> kTurning) × blocks     -> kDone
  //   kGiven -> kReflections -> kPanels × ⌈rest / kPanel⌉, without matrices -> kDone
  // Each but kDone -> kRefused.
  enum class Stage : std::uint8_t { kRefused, kCosines, kGiven, kReflections, kTurn, kPanels, kTurning, kDone };

  std::size_t OrthonormaliseGiven();
  void BeginBlock();
  std::size_t OrthonormaliseTurn();
  std::size_t MakePanel();
  std::size_t TurnPanel();
  void PutColumns(std::span<const double> columns);
  void Put(std::size_t mode, std::size_t row, double entry);

  Stage m_stage = Stage::kRefused;
  BasisSource m_source;
  std::shared_ptr<Basis> m_basis;
  std::size_t m_rows = 0;
  std::size_t m_modes = 0;        // given
  std::vector<double> m_columns;  // the given modes
  std::size_t m_next = 0;         // of the vectors or modes of this stage
  std::size_t m_part = 0;         // reflections, or rows, that the panel at hand has
  std::vector<std::size_t> m_rowOrder;
  std::optional<Completion> m_completion;

  // The block at hand: completed modes m_begin … m_begin + m_size − 1.
  std::size_t m_block = 0;  // that is next
  std::size_t m_begin = 0;
  std::size_t m_size = 0;
  std::size_t m_nextTurn = 0;
  std::vector<double> m_turn;  // its matrix, column after column
  std::size_t m_stride = 0;
  std::vector<double> m_panels;   // rows × m_stride, row after row
  std::vector<double> m_entries;  // of the matrix for the panel at hand, row after row
};

// At once. nullptr when the bytes are no basis for so many vertices. Cost: 2 rows² · modes multiplications.
[[nodiscard]] std::shared_ptr<const Basis> ReadBasis(std::span<const std::uint8_t> bytes, std::size_t vertices);

}  // namespace wobble::protocol
