// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/CloudHeader.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/ScanFiles.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <set>
#include <string_view>

#include "PcdFile.h"
#include "PlyFile.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** Takes the number at the front of a text off it. \return its digits without leading zeros. */
std::string_view takeDigits(std::string_view& text)
{
  text.remove_prefix(std::min(text.find_first_not_of('0'), text.size()));
  const std::size_t count = std::min(text.find_first_not_of("0123456789"), text.size());
  const std::string_view digits = text.substr(0, count);
  text.remove_prefix(count);
  return digits;
}

/** Orders names so that 2 comes before 10. */
bool naturalLess(const std::string& a, const std::string& b)
{
  const auto isDigit = [](char c) { return c >= '0' && c <= '9'; };
  std::string_view rest_a = a;
  std::string_view rest_b = b;
  while (!rest_a.empty() && !rest_b.empty())
  {
    if (isDigit(rest_a.front()) && isDigit(rest_b.front()))
    {
      const std::string_view number_a = takeDigits(rest_a);
      const std::string_view number_b = takeDigits(rest_b);
      if (number_a != number_b)
      {
        return number_a.size() != number_b.size() ? number_a.size() < number_b.size()
                                                  : number_a < number_b;
      }
    }
    else if (rest_a.front() != rest_b.front())
    {
      return rest_a.front() < rest_b.front();
    }
    else
    {
      rest_a.remove_prefix(1);
      rest_b.remove_prefix(1);
    }
  }
  return rest_a.size() != rest_b.size() ? rest_a.size() < rest_b.size() : a < b;
}

void requireSameLength(const std::vector<Eigen::Vector3f>& points,
                       const std::vector<float>& intensity)
{
  if (!intensity.empty() && intensity.size() != points.size())
  {
    throw std::logic_error("points and intensity differ in length");
  }
}

/** x y z [intensity] as float32, point after point: what all three formats hold. */
std::string packed(const std::vector<Eigen::Vector3f>& points,
                   const std::vector<float>& intensity,
                   bool always_intensity)
{
  const std::size_t fields = intensity.empty() && !always_intensity ? 3 : 4;
  std::string bytes(points.size() * fields * sizeof(float), '\0');
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const std::array<float, 4> values{points[i].x(), points[i].y(), points[i].z(),
                                      intensity.empty() ? 0.0F : intensity[i]};
    std::memcpy(&bytes[i * fields * sizeof(float)], values.data(), fields * sizeof(float));
  }
  return bytes;
}

CloudHeader headerOf(const std::vector<Eigen::Vector3f>& points,
                     const std::vector<float>& intensity)
{
  CloudHeader header;
  header.points = points.size();
  header.fields = {{"x"}, {"y"}, {"z"}};
  if (!intensity.empty())
  {
    header.fields.push_back({"intensity"});
  }
  return header;
}

/** The fifth of five columns. */
void readRingColumn(const std::string& path, const std::string& bytes, Scan& scan)
{
  constexpr float max_ring = 65535;
  scan.ring.reserve(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    float ring = 0;
    std::memcpy(&ring, &bytes[(5 * i + 4) * sizeof(float)], sizeof(float));
    if (!(ring >= 0 && ring <= max_ring))
    {
      throw UserError(path + ": the fifth number of point " + std::to_string(i) +
                      " is not the number of a ring; the file has other columns than x y z "
                      "intensity ring");
    }
    scan.ring.push_back(static_cast<std::uint16_t>(ring));
  }
}

/** The file of rings beside a scan, if there is one. */
void readRingFile(const std::string& path, Scan& scan)
{
  const std::string ring_path = fs::path(path).replace_extension(".ring").string();
  if (!fs::exists(ring_path))
  {
    return;
  }
  const std::string rings = readWhole(ring_path);
  if (rings.size() != scan.size())
  {
    throw UserError(ring_path + ": has " + std::to_string(rings.size()) +
                    " rings, but the scan has " + std::to_string(scan.size()) + " points");
  }
  for (const char ring : rings)
  {
    scan.ring.push_back(static_cast<std::uint8_t>(ring));
  }
}
}  // namespace

std::vector<std::string> listFiles(const std::string& folder,
                                   const std::function<bool(const std::string&)>& wanted)
{
  if (!fs::is_directory(folder))
  {
    throw UserError(folder + ": no such folder");
  }
  std::vector<std::string> files;
  for (const auto& entry : entriesOf(folder))
  {
    const bool is_hidden = entry.path().filename().string()[0] == '.';  // as ._1.pcd of macOS
    if (!is_hidden && entry.is_regular_file() && wanted(entry.path().string()))
    {
      files.push_back(entry.path().string());
    }
  }
  std::sort(files.begin(), files.end(), naturalLess);
  return files;
}

std::string lowerExtension(const std::string& path)
{
  return lowered(fs::path(path).extension().string());
}

BinLayout binLayoutOf(const std::string& path)
{
  constexpr std::size_t min_points = 100;
  constexpr std::size_t min_rings = 4;
  constexpr float max_ring = 255;
  const std::string bytes = readWhole(path);
  constexpr std::size_t step = 5 * sizeof(float);
  if (bytes.size() % step != 0 || bytes.size() < min_points * step)
  {
    return BinLayout::xyzi;
  }
  std::set<float> rings;
  bool fractions = false;  // among the coordinates
  for (std::size_t at = 0; at < bytes.size(); at += step)
  {
    std::array<float, 5> row{};
    std::memcpy(row.data(), &bytes[at], step);
    if (!(row[4] >= 0 && row[4] <= max_ring && row[4] == std::floor(row[4])))
    {
      return BinLayout::xyzi;
    }
    rings.insert(row[4]);
    fractions = fractions || std::any_of(row.begin(), row.begin() + 3,
                                         [](float x) { return x != std::floor(x); });
  }
  return fractions && rings.size() >= min_rings ? BinLayout::xyzir : BinLayout::xyzi;
}

Scan readBin(const std::string& path, BinLayout layout)
{
  const std::string bytes = readWhole(path);
  const std::size_t columns = layout == BinLayout::xyzir ? 5 : 4;
  const std::size_t step = columns * sizeof(float);
  if (bytes.size() % step != 0)
  {
    throw UserError(path + ": " + std::to_string(bytes.size()) + " bytes are not whole points of " +
                    std::to_string(columns) + " floats (x y z intensity" +
                    (columns == 5 ? " ring" : "") +
                    "); the file is cut short, or has other columns: write it with these");
  }
  Scan scan;
  const std::size_t count = bytes.size() / step;
  scan.points.resize(count);
  scan.intensity.resize(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    std::memcpy(scan.points[i].data(), &bytes[i * step], 3 * sizeof(float));
    std::memcpy(&scan.intensity[i], &bytes[i * step + 3 * sizeof(float)], sizeof(float));
  }
  if (layout == BinLayout::xyzir)
  {
    readRingColumn(path, bytes, scan);
  }
  else
  {
    readRingFile(path, scan);
  }
  return scan;
}

void writeBin(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity)
{
  requireSameLength(points, intensity);
  writeWhole(path, packed(points, intensity, true), Durable::no);
}

void writePcd(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity)
{
  requireSameLength(points, intensity);
  writeWhole(path, pcdHeader(headerOf(points, intensity)) + packed(points, intensity, false));
}

void writePly(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity)
{
  requireSameLength(points, intensity);
  writeWhole(path, plyHeader(headerOf(points, intensity)) + packed(points, intensity, false));
}

void writeCloud(const std::string& path,
                const std::vector<Eigen::Vector3f>& points,
                const std::vector<float>& intensity)
{
  const std::string extension = lowerExtension(path);
  if (extension == ".pcd")
  {
    writePcd(path, points, intensity);
  }
  else if (extension == ".ply")
  {
    writePly(path, points, intensity);
  }
  else if (extension == ".bin")
  {
    writeBin(path, points, intensity);
  }
  else
  {
    throw UserError(path + ": unknown kind of cloud; use .pcd, .ply or .bin");
  }
}

Scan readCloud(const std::string& path)
{
  FieldConventions conventions;
  return readCloud(path, conventions);
}

Scan readCloud(const std::string& path, FieldConventions& conventions)
{
  const std::string extension = lowerExtension(path);
  if (extension == ".bin")
  {
    return readBin(path);
  }
  if (extension == ".pcd")
  {
    return readPcd(path, conventions);
  }
  if (extension == ".ply")
  {
    return readPly(path, conventions);
  }
  const std::string advice = conversionAdvice(path);
  throw UserError(path + ": " +
                  (advice.empty() ? "unknown kind of cloud; use .bin, .pcd or .ply" : advice));
}

bool isCloudFile(const std::string& path)
{
  const std::string extension = lowerExtension(path);
  return extension == ".bin" || extension == ".pcd" || extension == ".ply";
}

namespace
{
/** What is in a folder without scans, for messages: a capture, or a folder that has scans. */
std::string foundInstead(const std::string& folder)
{
  for (const auto& entry : entriesIfReadable(folder))
  {
    const std::string within = entry.path().string();
    if (recordingKind(within) == RecordingKind::capture)
    {
      return "; give its capture " + within;
    }
    const auto files = entriesIfReadable(entry.path());
    if (std::any_of(files.begin(), files.end(),
                    [](const auto& file) { return isCloudFile(file.path().string()); }))
    {
      return "; its folder " + within + " has";
    }
  }
  return "";
}
}  // namespace

std::vector<std::string> listCloudFiles(const std::string& folder)
{
  const auto files = listFiles(folder, isCloudFile);
  if (files.empty())
  {
    throw UserError(folder + ": has no .bin, .pcd or .ply files" + foundInstead(folder));
  }
  for (const std::string& file : files)
  {
    if (lowerExtension(file) != lowerExtension(files.front()))
    {
      throw UserError(folder + ": holds scans of two kinds (" + lowerExtension(files.front()) +
                      " and " + lowerExtension(file) + "); put them into two folders");
    }
  }
  return files;
}

std::vector<std::string> listBinFiles(const std::string& folder)
{
  auto files =
      listFiles(folder, [](const std::string& path) { return lowerExtension(path) == ".bin"; });
  if (files.empty())
  {
    throw UserError(folder + ": has no .bin files");
  }
  return files;
}
}  // namespace dyslam
