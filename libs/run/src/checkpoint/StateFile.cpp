// SPDX-License-Identifier: BSD-3-Clause
#include "StateFile.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <libdeflate.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

namespace dyslam
{
namespace
{
constexpr std::string_view magic = "DYSLAM STATE 18\n";

struct PartHeader
{
  std::uint64_t size = 0;
  std::uint64_t sum = 0;
};

[[noreturn]] void fail(const std::string& path, const std::string& what)
{
  throw UserError(path + ": " + what + "; the run cannot be resumed from it, start it anew");
}
}  // namespace

std::uint32_t checksum(std::string_view bytes, std::uint32_t sum)
{
  return libdeflate_crc32(sum, bytes.data(), bytes.size());
}

StateFileWriter::StateFileWriter(const std::string& path)
    : pending_(path), file_(pending_.temporary(), std::ios::binary)
{
  file_ << magic;
  requireWritten();
}

void StateFileWriter::requireWritten()
{
  if (!file_)
  {
    throw UserError(pending_.path() + ": cannot be written: " +
                    (errno != 0 ? std::strerror(errno) : "unknown reason"));
  }
}

void StateFileWriter::add(const std::function<void(StateArchive&)>& save)
{
  PartHeader header;
  const auto write_header = [&]
  { file_.write(reinterpret_cast<const char*>(&header), sizeof header); };
  const auto begin = file_.tellp();
  write_header();
  std::uint32_t sum = 0;
  StateArchive archive(
      [&](std::string_view bytes)
      {
        file_.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        requireWritten();  // to detect a full disk early
        header.size += bytes.size();
        sum = checksum(bytes, sum);
      });
  save(archive);
  archive.flush();
  header.sum = sum;
  file_.seekp(begin);
  write_header();
  file_.seekp(0, std::ios::end);
  requireWritten();
}

void StateFileWriter::add(std::string_view part)
{
  const PartHeader header{part.size(), checksum(part)};
  file_.write(reinterpret_cast<const char*>(&header), sizeof header);
  file_.write(part.data(), static_cast<std::streamsize>(part.size()));
  requireWritten();
}

void StateFileWriter::commit()
{
  file_.close();
  requireWritten();
  pending_.commit();
}

StateFileReader::StateFileReader(const std::string& path, std::size_t parts)
    : path_(path), file_(openBinary(path)), left_(std::filesystem::file_size(path))
{
  std::string found(magic.size(), ' ');
  read(found.data(), found.size());
  if (found != magic)
  {
    fail(path_, "is no state of a run of this version of DySLAM");
  }
  for (std::size_t i = 0; i < parts; ++i)
  {
    PartHeader header;
    read(&header, sizeof header);
    parts_.push_back({static_cast<std::uint64_t>(file_.tellg()), header.size});
    test(parts_.back(), header.sum);
  }
  if (left_ != 0)
  {
    fail(path_, "has trailing data");
  }
}

void StateFileReader::read(void* data, std::uint64_t size)
{
  if (size > left_ || !file_.read(static_cast<char*>(data), static_cast<std::streamsize>(size)))
  {
    requireReadable(file_, path_);
    fail(path_, "is cut short");
  }
  left_ -= size;
}

void StateFileReader::test(const Part& part, std::uint64_t sum)
{
  constexpr std::uint64_t piece = 1 << 20;  // [bytes]
  if (part.size > left_)
  {
    fail(path_, "is cut short");
  }
  std::string bytes(static_cast<std::size_t>(std::min(piece, part.size)), ' ');
  std::uint32_t found = 0;
  for (std::uint64_t rest = part.size; rest > 0; rest -= bytes.size())
  {
    bytes.resize(static_cast<std::size_t>(std::min(piece, rest)));
    read(bytes.data(), bytes.size());
    found = checksum(bytes, found);
  }
  if (found != sum)
  {
    fail(path_, "is damaged");
  }
}

StateArchive StateFileReader::part(std::size_t i)
{
  const Part& part = parts_.at(i);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(part.offset));
  return StateArchive(
      [this](void* data, std::size_t size)
      {
        const bool whole = static_cast<bool>(
            file_.read(static_cast<char*>(data), static_cast<std::streamsize>(size)));
        requireReadable(file_, path_);
        return whole;
      },
      part.size);
}
}  // namespace dyslam
