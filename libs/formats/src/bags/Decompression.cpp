// SPDX-License-Identifier: BSD-3-Clause
#include "Decompression.h"

#include <bzlib.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <new>
#include <ostream>
#include <vector>

namespace dyslam
{
namespace
{
constexpr std::size_t buffer_size = std::size_t{1} << 18U;
constexpr std::uint64_t largest = std::uint64_t{1} << 32U;  //!< where the size is unknown [bytes]

/** What one step of an unpacker did. */
struct Step
{
  std::size_t consumed = 0;
  std::size_t produced = 0;
  bool finished = false;
  std::string error;
};
using Unpacker = std::function<Step(std::string_view, std::vector<char>&)>;

Unpacker bz2Unpacker()
{
  const auto close = [](bz_stream* stream)
  {
    BZ2_bzDecompressEnd(stream);
    delete stream;
  };
  const std::shared_ptr<bz_stream> stream(new bz_stream{}, close);
  if (BZ2_bzDecompressInit(stream.get(), 0, 0) != BZ_OK)
  {
    throw std::bad_alloc();
  }
  return [stream](std::string_view in, std::vector<char>& out)
  {
    const auto part = static_cast<unsigned>(
        std::min<std::size_t>(in.size(), std::numeric_limits<unsigned>::max()));
    stream->next_in = const_cast<char*>(in.data());  // it only reads
    stream->avail_in = part;
    stream->next_out = out.data();
    stream->avail_out = static_cast<unsigned>(out.size());
    const int code = BZ2_bzDecompress(stream.get());
    Step step{part - stream->avail_in, out.size() - stream->avail_out, code == BZ_STREAM_END, ""};
    if (code != BZ_OK && code != BZ_STREAM_END)
    {
      step.error = "bzip2 error " + std::to_string(code);
    }
    return step;
  };
}

Unpacker lz4Unpacker()
{
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0)
  {
    throw std::bad_alloc();
  }
  const std::shared_ptr<LZ4F_dctx> owned(context, LZ4F_freeDecompressionContext);
  return [owned](std::string_view in, std::vector<char>& out)
  {
    std::size_t consumed = in.size();
    std::size_t produced = out.size();
    const std::size_t code =
        LZ4F_decompress(owned.get(), out.data(), &produced, in.data(), &consumed, nullptr);
    const bool failed = LZ4F_isError(code) != 0;
    return Step{consumed, produced, !failed && code == 0,
                failed ? std::string(LZ4F_getErrorName(code)) : ""};
  };
}

Unpacker zstdUnpacker()
{
  const std::shared_ptr<ZSTD_DCtx> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (!context)
  {
    throw std::bad_alloc();
  }
  return [context](std::string_view in, std::vector<char>& out)
  {
    ZSTD_inBuffer from{in.data(), in.size(), 0};
    ZSTD_outBuffer to{out.data(), out.size(), 0};
    const std::size_t code = ZSTD_decompressStream(context.get(), &to, &from);
    const bool failed = ZSTD_isError(code) != 0;
    return Step{from.pos, to.pos, !failed && code == 0,
                failed ? std::string(ZSTD_getErrorName(code)) : ""};
  };
}

/** \throws UserError if the unpacker found damage. */
void requireSound(const Step& step, const std::string& place)
{
  if (!step.error.empty())
  {
    throw UserError(place + ": damaged compressed data (" + step.error + ")");
  }
}

[[noreturn]] void throwCutShort(const std::string& place)
{
  throw UserError(place + ": compressed data end early");
}

std::string unpack(const Unpacker& unpacker,
                   std::string_view data,
                   std::uint64_t size,
                   const std::string& place)
{
  const std::uint64_t limit = size == 0 ? largest : size;
  std::vector<char> buffer(buffer_size);
  std::string result;
  for (Step step; !step.finished;)
  {
    step = unpacker(data, buffer);
    requireSound(step, place);
    if (result.size() + step.produced > limit)
    {
      throw UserError(place + ": damaged: unpacks to more than " + std::to_string(limit) +
                      " bytes");
    }
    result.append(buffer.data(), step.produced);
    data.remove_prefix(step.consumed);
    if (!step.finished && step.produced == 0 && (data.empty() || step.consumed == 0))
    {
      throwCutShort(place);
    }
  }
  if (size != 0 && result.size() != size)
  {
    throw UserError(place + ": damaged: unpacks to " + std::to_string(result.size()) +
                    " bytes instead of " + std::to_string(size));
  }
  return result;
}
}  // namespace

std::string decompressed(const std::string& compression,
                         std::string_view data,
                         std::uint64_t size,
                         const std::string& place)
{
  if (compression == "none" || compression.empty())
  {
    return std::string(data);
  }
  if (compression == "bz2")
  {
    return unpack(bz2Unpacker(), data, size, place);
  }
  if (compression == "lz4")
  {
    return unpack(lz4Unpacker(), data, size, place);
  }
  if (compression == "zstd")
  {
    return unpack(zstdUnpacker(), data, size, place);
  }
  throw UserError(place + ": compression '" + compression +
                  "' is not supported (bz2, lz4, zstd or none); rewrite the bag uncompressed");
}

void unpackZstdFile(const std::string& path,
                    std::ostream& out,
                    const std::function<void(double, std::uint64_t)>& progress)
{
  std::ifstream file = openBinary(path);
  const auto size = static_cast<double>(std::filesystem::file_size(path));
  std::uint64_t read = 0;
  std::uint64_t unpacked = 0;
  const Unpacker unpacker = zstdUnpacker();
  std::vector<char> packed(buffer_size);
  std::vector<char> buffer(buffer_size);
  Step step;  // the last one: a file may have several frames, of which each finishes
  while (file.read(packed.data(), static_cast<std::streamsize>(packed.size())) || file.gcount() > 0)
  {
    std::string_view data(packed.data(), static_cast<std::size_t>(file.gcount()));
    read += data.size();
    while (!data.empty() || (!step.finished && step.produced == buffer.size()))
    {
      step = unpacker(data, buffer);
      requireSound(step, path);
      if (!out.write(buffer.data(), static_cast<std::streamsize>(step.produced)))
      {
        return;
      }
      data.remove_prefix(step.consumed);
      unpacked += step.produced;
      progress(static_cast<double>(read - data.size()) / size, unpacked);
    }
  }
  requireReadable(file, path);
  if (!step.finished)
  {
    throwCutShort(path);
  }
}

std::uint64_t zstdContentSize(const std::string& path)
{
  constexpr std::size_t largest_header = 18;
  std::string header(largest_header, '\0');
  std::ifstream file = openBinary(path);
  file.read(header.data(), static_cast<std::streamsize>(header.size()));
  const auto size =
      ZSTD_getFrameContentSize(header.data(), static_cast<std::size_t>(file.gcount()));
  return size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR ? 0 : size;
}
}  // namespace dyslam
