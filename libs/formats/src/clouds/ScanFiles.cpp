// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/base/Words.h>
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

#include "CloudColumns.h"
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

/** x y z intensity, as float32. */
Scan kittiScan(const std::string& bytes, const FieldConventions& conventions)
{
  constexpr std::size_t step = 4 * sizeof(float);
  Scan scan;
  const std::size_t count = bytes.size() / step;
  scan.points.resize(count);
  scan.intensity.resize(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    std::memcpy(scan.points[i].data(), &bytes[i * step], 3 * sizeof(float));
    std::memcpy(&scan.intensity[i], &bytes[i * step + 3 * sizeof(float)], sizeof(float));
  }
  conventions.toMetres(scan);
  return scan;
}

/** Name of the field of a column, as in a PCD. */
std::string fieldOfColumn(char letter)
{
  switch (letter)
  {
    case 'i':
      return "intensity";
    case 'r':
      return "ring";
    case 't':
      return "time";
    default:
      return {letter};
  }
}

/** \throws UserError for a number of a ring that is none. */
void requireRing(float ring, const std::string& path, const std::string& layout, std::size_t point)
{
  constexpr float max_ring = 65535;
  if (!(ring >= 0 && ring <= max_ring && ring == std::floor(ring)))
  {
    throw UserError(path + ": number " + std::to_string(layout.find('r') + 1) + " of point " +
                    std::to_string(point) +
                    " is not that of a ring; the file has other columns than " + columnsOf(layout));
  }
}

/** \pre the bytes are whole points of the layout */
Scan scanOfColumns(const std::string& path,
                   const std::string& bytes,
                   const std::string& layout,
                   FieldConventions& conventions)
{
  CloudColumns columns(path);
  for (const char letter : layout)
  {
    columns.declare(fieldOfColumn(letter), {CloudNumber::Kind::floating, sizeof(float)});
  }
  const std::size_t count = bytes.size() / (layout.size() * sizeof(float));
  columns.reserve(count);
  for (std::size_t i = 0, at = 0; i < count; ++i)
  {
    for (std::size_t column = 0; column < layout.size(); ++column, at += sizeof(float))
    {
      if (layout[column] == 'r')
      {
        float ring = 0;
        std::memcpy(&ring, &bytes[at], sizeof ring);
        requireRing(ring, path, layout, i);
      }
      columns.addBytes(column, &bytes[at]);
    }
  }
  return columns.scan(conventions);
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
    throw UserError(ring_path + ": has " + counted(rings.size(), "ring") + ", but the scan has " +
                    counted(scan.size(), "point"));
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

std::string binLayoutOf(const std::string& path)
{
  constexpr std::size_t min_points = 100;
  constexpr std::size_t min_rings = 4;
  constexpr float max_ring = 255;
  const std::string bytes = readWhole(path);
  constexpr std::size_t step = 5 * sizeof(float);
  if (bytes.size() % step != 0 || bytes.size() < min_points * step)
  {
    return kitti_layout;
  }
  std::set<float> rings;
  bool fractions = false;  // among the coordinates
  for (std::size_t at = 0; at < bytes.size(); at += step)
  {
    std::array<float, 5> row{};
    std::memcpy(row.data(), &bytes[at], step);
    if (!(row[4] >= 0 && row[4] <= max_ring && row[4] == std::floor(row[4])))
    {
      return kitti_layout;
    }
    rings.insert(row[4]);
    fractions = fractions || std::any_of(row.begin(), row.begin() + 3,
                                         [](float x) { return x != std::floor(x); });
  }
  return fractions && rings.size() >= min_rings ? nuscenes_layout : kitti_layout;
}

void requireBinLayout(const std::string& layout)
{
  constexpr const char* letters = "xyzirt_";
  const auto occurs = [&layout](char letter)
  { return std::count(layout.begin(), layout.end(), letter); };
  const bool is_known = layout.find_first_not_of(letters) == std::string::npos;
  const bool is_unique =
      std::all_of(layout.begin(), layout.end(),
                  [&](char letter) { return letter == '_' || occurs(letter) == 1; });
  if (!is_known || !is_unique || occurs('x') == 0 || occurs('y') == 0 || occurs('z') == 0)
  {
    throw UserError(
        "--bin-layout " + layout +
        ": give a letter for each column of the .bin files, as in xyzi: x y z once each, i "
        "(intensity), r (ring), t (time) at most once, _ for any other");
  }
}

std::string columnsOf(const std::string& layout)
{
  std::string columns;
  for (const char letter : layout)
  {
    appendWord(columns, fieldOfColumn(letter), " ");
  }
  return columns;
}

Scan readBin(const std::string& path, const std::string& layout)
{
  FieldConventions conventions;
  return readBin(path, layout, conventions);
}

Scan readBin(const std::string& path, const std::string& layout, FieldConventions& conventions)
{
  const std::string bytes = readWhole(path);
  const std::size_t columns = layout.size();
  if (bytes.size() % (columns * sizeof(float)) != 0)
  {
    throw UserError(
        path + ": " + std::to_string(bytes.size()) + " bytes are not whole points of " +
        counted(columns, "float") + " (" + columnsOf(layout) +
        "); the file is cut short, or has other columns, which --bin-layout of dyslam and "
        "scans2rawlog names: xyz without intensity");
  }
  Scan scan = layout == kitti_layout ? kittiScan(bytes, conventions)
                                     : scanOfColumns(path, bytes, layout, conventions);
  if (layout.find('r') == std::string::npos)
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
    return readBin(path, kitti_layout, conventions);
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
