#include "tests/bench/codec/zstd.h"

#define ZSTD_STATIC_LINKING_ONLY  // for frames without the magic number
#include <zstd.h>

#include <memory>
#include <stdexcept>

namespace wobble::bench {
namespace {

std::size_t Check(std::size_t result) {
  if (ZSTD_isError(result) != 0) throw std::runtime_error(ZSTD_getErrorName(result));
  return result;
}

}  // namespace

std::vector<std::uint8_t> CompressWithZstd(std::span<const std::uint8_t> bytes) {
  thread_local const std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context(ZSTD_createCCtx(), &ZSTD_freeCCtx);
  Check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_format, ZSTD_f_zstd1_magicless));
  Check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_contentSizeFlag, 0));
  Check(ZSTD_CCtx_setParameter(context.get(), ZSTD_c_compressionLevel, 19));
  std::vector<std::uint8_t> out(ZSTD_compressBound(bytes.size()));
  out.resize(Check(ZSTD_compress2(context.get(), out.data(), out.size(), bytes.data(), bytes.size())));
  return out;
}

std::vector<std::uint8_t> DecompressWithZstd(std::span<const std::uint8_t> bytes, std::size_t size) {
  thread_local const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(), &ZSTD_freeDCtx);
  Check(ZSTD_DCtx_setParameter(context.get(), ZSTD_d_format, ZSTD_f_zstd1_magicless));
  std::vector<std::uint8_t> out(size);
  if (Check(ZSTD_decompressDCtx(context.get(), out.data(), out.size(), bytes.data(), bytes.size())) != size) {
    throw std::runtime_error("zstd: the decompressed size differs");
  }
  return out;
}

}  // namespace wobble::bench
