// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/io/CloudFiles.h>
#include <pcl/PCLPointCloud2.h>
#include <pcl/console/print.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <optional>
#include <sstream>
#include <vector>

#include "TextFile.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
std::string lowerExtension(const std::string& path)
{
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

/** One field of a PCL blob as numbers, whatever its type. */
class FieldReader
{
 public:
  FieldReader(const pcl::PCLPointCloud2& blob,
              const pcl::PCLPointField& field,
              const std::string& path)
      : blob_(blob), field_(field), path_(path)
  {
  }

  [[nodiscard]] double operator()(std::size_t i) const
  {
    const std::uint8_t* at = blob_.data.data() + i * blob_.point_step + field_.offset;
    switch (field_.datatype)
    {
      case pcl::PCLPointField::INT8:
        return as<std::int8_t>(at);
      case pcl::PCLPointField::UINT8:
      case pcl::PCLPointField::BOOL:
        return as<std::uint8_t>(at);
      case pcl::PCLPointField::INT16:
        return as<std::int16_t>(at);
      case pcl::PCLPointField::UINT16:
        return as<std::uint16_t>(at);
      case pcl::PCLPointField::INT32:
        return as<std::int32_t>(at);
      case pcl::PCLPointField::UINT32:
        return as<std::uint32_t>(at);
      case pcl::PCLPointField::INT64:
        return as<std::int64_t>(at);
      case pcl::PCLPointField::UINT64:
        return as<std::uint64_t>(at);
      case pcl::PCLPointField::FLOAT32:
        return as<float>(at);
      case pcl::PCLPointField::FLOAT64:
        return as<double>(at);
      default:
        throw UserError(path_ + ": field '" + field_.name + "' is of a type that cannot be read (" +
                        std::to_string(field_.datatype) + "); save it as float32");
    }
  }
  [[nodiscard]] bool isWhole() const
  {
    return field_.datatype != pcl::PCLPointField::FLOAT32 &&
           field_.datatype != pcl::PCLPointField::FLOAT64;
  }

 private:
  template <typename T>
  static double as(const std::uint8_t* at)
  {
    T value;
    std::memcpy(&value, at, sizeof value);
    return static_cast<double>(value);
  }
  const pcl::PCLPointCloud2& blob_;
  const pcl::PCLPointField& field_;
  const std::string& path_;
};

std::optional<FieldReader> findField(const pcl::PCLPointCloud2& blob,
                                     const std::string& path,
                                     std::initializer_list<const char*> names)
{
  for (const char* name : names)
  {
    for (const auto& field : blob.fields)
    {
      if (field.name == name)
      {
        return FieldReader(blob, field, path);
      }
    }
  }
  return std::nullopt;
}

/** Reads all points before the times: seconds as they are, whole numbers as nanoseconds. */
void fillTimes(const FieldReader& reader, Scan& scan)
{
  std::vector<double> times(scan.size());
  double first = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < times.size(); ++i)
  {
    times[i] = reader(i) * (reader.isWhole() ? 1e-9 : 1.0);
    first = std::isfinite(times[i]) ? std::min(first, times[i]) : first;
  }
  // Times since 1970 become the scan's stamp; small ones already count from it.
  if (std::isfinite(first) && std::abs(first) > 3600)
  {
    scan.stamp = first;
  }
  for (const double time : times)
  {
    scan.time.push_back(static_cast<float>(time - scan.stamp));
  }
}

Scan scanFromBlob(const pcl::PCLPointCloud2& blob, const std::string& path)
{
  const auto x = findField(blob, path, {"x"});
  const auto y = findField(blob, path, {"y"});
  const auto z = findField(blob, path, {"z"});
  if (!x || !y || !z)
  {
    throw UserError(path + ": has no fields x, y and z");
  }
  const std::size_t count = static_cast<std::size_t>(blob.width) * blob.height;
  if (blob.data.size() < count * blob.point_step)
  {
    throw UserError(path + ": is cut short");
  }
  Scan scan;
  scan.points.reserve(count);
  for (std::size_t i = 0; i < count; ++i)
  {
    scan.points.emplace_back(static_cast<float>((*x)(i)), static_cast<float>((*y)(i)),
                             static_cast<float>((*z)(i)));
  }
  if (const auto intensity = findField(
          blob, path, {"intensity", "scalar_intensity", "scalar_Intensity", "reflectivity"}))
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      scan.intensity.push_back(static_cast<float>((*intensity)(i)));
    }
  }
  if (const auto ring = findField(blob, path, {"ring"}))
  {
    for (std::size_t i = 0; i < count; ++i)
    {
      scan.ring.push_back(static_cast<std::uint16_t>((*ring)(i)));
    }
  }
  if (const auto time = findField(blob, path, {"time", "t", "timestamp"}))
  {
    fillTimes(*time, scan);
  }
  return scan;
}

/** PCL's PCD reader trusts the header and reads past the end of a file that is cut short.
 * \throws UserError unless the data the header announces are there. */
void requireWholePcd(const std::string& path)
{
  std::ifstream in = openBinary(path);
  std::string encoding;
  std::vector<std::size_t> sizes;
  std::vector<std::size_t> counts;
  std::size_t points = 0;
  for (std::string line; encoding.empty() && std::getline(in, line);)
  {
    std::istringstream words(line);
    std::string key;
    words >> key;
    std::size_t value = 0;
    if (key == "SIZE" || key == "COUNT")
    {
      auto& list = key == "SIZE" ? sizes : counts;
      while (words >> value)
      {
        list.push_back(value);
      }
    }
    else if (key == "POINTS")
    {
      words >> points;
    }
    else if (key == "DATA")
    {
      words >> encoding;
    }
  }
  if (encoding.empty() || sizes.empty())
  {
    throw UserError(path + ": is not a PCD file: its header is missing or damaged");
  }
  const auto header = static_cast<std::uint64_t>(in.tellg());
  std::uint64_t needed = 0;
  if (encoding == "binary")
  {
    for (std::size_t i = 0; i < sizes.size(); ++i)
    {
      needed += sizes[i] * (i < counts.size() ? counts[i] : 1);
    }
    needed *= points;
  }
  else if (encoding == "binary_compressed")
  {
    std::uint32_t compressed = 0;
    std::array<char, sizeof(compressed)> bytes{};
    in.read(bytes.data(), bytes.size());
    std::memcpy(&compressed, bytes.data(), bytes.size());
    needed = 2 * sizeof(compressed) + compressed;
  }
  if (std::filesystem::file_size(path) < header + needed)
  {
    throw UserError(path + ": is cut short: its header announces " + std::to_string(points) +
                    " points");
  }
}

/** PCL prints what it dislikes and returns a code: we want an exception and no printing. */
Scan readWithPcl(const std::string& path, bool ply)
{
  (void)openBinary(path);
  if (!ply)
  {
    requireWholePcd(path);
  }
  pcl::console::setVerbosityLevel(pcl::console::L_ALWAYS);
  pcl::PCLPointCloud2 blob;
  int code = -1;
  try
  {
    code = ply ? pcl::PLYReader().read(path, blob) : pcl::PCDReader().read(path, blob);
  }
  catch (const std::exception& error)
  {
    throw UserError(path + ": cannot be read: " + error.what());
  }
  if (code < 0 || blob.fields.empty())
  {
    throw UserError(path + ": is not a " + (ply ? "PLY" : "PCD") + " file or is damaged");
  }
  return scanFromBlob(blob, path);
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

/** Orders names so that 2 comes before 10. */
bool naturalLess(const std::string& a, const std::string& b)
{
  const auto digit = [](char c) { return c >= '0' && c <= '9'; };
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size())
  {
    if (digit(a[i]) && digit(b[j]))
    {
      const std::size_t begin_a = a.find_first_not_of('0', i);
      const std::size_t begin_b = b.find_first_not_of('0', j);
      i = begin_a == std::string::npos ? a.size() : begin_a;
      j = begin_b == std::string::npos ? b.size() : begin_b;
      std::size_t end_i = i;
      std::size_t end_j = j;
      for (; end_i < a.size() && digit(a[end_i]); ++end_i)
      {
      }
      for (; end_j < b.size() && digit(b[end_j]); ++end_j)
      {
      }
      if (end_i - i != end_j - j)
      {
        return end_i - i < end_j - j;
      }
      const int order = a.compare(i, end_i - i, b, j, end_j - j);
      if (order != 0)
      {
        return order < 0;
      }
      i = end_i;
      j = end_j;
    }
    else if (a[i] != b[j])
    {
      return a[i] < b[j];
    }
    else
    {
      ++i;
      ++j;
    }
  }
  return a.size() - i < b.size() - j || (a.size() - i == b.size() - j && a < b);
}
}  // namespace

Scan readBin(const std::string& path)
{
  const std::string bytes = readWhole(path);
  constexpr std::size_t step = 4 * sizeof(float);
  if (bytes.size() % step != 0)
  {
    throw UserError(path + ": " + std::to_string(bytes.size()) +
                    " bytes are not whole points of 4 floats; the file is cut short or no scan");
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
  const std::string ring_path = fs::path(path).replace_extension(".ring").string();
  if (fs::exists(ring_path))
  {
    const std::string rings = readWhole(ring_path);
    if (rings.size() != count)
    {
      throw UserError(ring_path + ": has " + std::to_string(rings.size()) +
                      " rings, but the scan has " + std::to_string(count) + " points");
    }
    for (const char ring : rings)
    {
      scan.ring.push_back(static_cast<std::uint8_t>(ring));
    }
  }
  return scan;
}

void writeBin(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity)
{
  requireSameLength(points, intensity);
  writeWhole(path, packed(points, intensity, true));
}

bool isCloudFile(const std::string& path)
{
  const std::string extension = lowerExtension(path);
  return extension == ".bin" || extension == ".pcd" || extension == ".ply";
}

Scan readCloud(const std::string& path)
{
  const std::string extension = lowerExtension(path);
  if (extension == ".bin")
  {
    return readBin(path);
  }
  if (extension == ".pcd" || extension == ".ply")
  {
    return readWithPcl(path, extension == ".ply");
  }
  throw UserError(path + ": unknown kind of cloud; use .bin, .pcd or .ply");
}

void writePcd(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity)
{
  requireSameLength(points, intensity);
  const bool with = !intensity.empty();
  const std::string count = std::to_string(points.size());
  const std::string header =
      std::string("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n") +
      (with ? "FIELDS x y z intensity\nSIZE 4 4 4 4\nTYPE F F F F\n"
              "COUNT 1 1 1 1\n"
            : "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\n") +
      "WIDTH " + count + "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
  writeWhole(path, header + packed(points, intensity, false));
}

void writePly(const std::string& path,
              const std::vector<Eigen::Vector3f>& points,
              const std::vector<float>& intensity)
{
  requireSameLength(points, intensity);
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(points.size()) +
      "\nproperty float x\nproperty float y\nproperty float z\n" +
      (intensity.empty() ? "" : "property float intensity\n") + "end_header\n";
  writeWhole(path, header + packed(points, intensity, false));
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

std::vector<std::string> listCloudFiles(const std::string& folder)
{
  if (!fs::is_directory(folder))
  {
    throw UserError(folder + ": no such folder");
  }
  std::vector<std::string> files;
  for (const auto& entry : fs::directory_iterator(folder))
  {
    if (entry.is_regular_file() && isCloudFile(entry.path().string()))
    {
      files.push_back(entry.path().string());
    }
  }
  if (files.empty())
  {
    throw UserError(folder + ": has no .bin, .pcd or .ply files");
  }
  std::sort(files.begin(), files.end(), naturalLess);
  for (const std::string& file : files)
  {
    if (lowerExtension(file) != lowerExtension(files.front()))
    {
      throw UserError(folder + ": holds scans of two kinds (" + lowerExtension(files.front()) +
                      " and " + lowerExtension(file) + "); part them into two folders");
    }
  }
  return files;
}
}  // namespace dyslam
