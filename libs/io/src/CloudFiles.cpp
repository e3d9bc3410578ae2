// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/formats/RecordingKind.h>
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

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
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
  (void)readWhole(path);  // PCL takes what it cannot read for the end, or maps it and is killed
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

}  // namespace

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
  const std::string advice = conversionAdvice(path);
  throw UserError(path + ": " +
                  (advice.empty() ? "unknown kind of cloud; use .bin, .pcd or .ply" : advice));
}

}  // namespace dyslam
