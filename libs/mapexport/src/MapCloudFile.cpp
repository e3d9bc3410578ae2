// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/mapexport/MapCloudFile.h>
#include <dyslam/mapexport/MapExport.h>
#include <dyslam/mapexport/MapFormat.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "CloudFormat.h"

namespace dyslam
{
namespace
{
std::unique_ptr<CloudFormat> formatOf(const std::string& path, const CloudDescription& layout)
{
  const MapFormat format = mapFormatOf(path);
  if (format.make_cloud == nullptr)
  {
    throw UserError(path + ": is no cloud: " + format.ending + " is for " + format.help);
  }
  return format.make_cloud(layout);
}
}  // namespace

struct MapCloudFile::Impl
{
  Impl(const std::string& path, const CloudDescription& with)
      : layout(with), format(formatOf(path, with)), pending(path)
  {
    errno = 0;
    file.open(pending.temporary(), std::ios::binary);
    write(format->header(summary));
  }

  void write(const std::string& bytes)
  {
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    requireGood();
  }
  /** \throws UserError if the format cannot express the coordinates. \param p relative to the
   * origin [m] */
  void requireReach(const Eigen::Vector3d& p) const
  {
    const double farthest = p.cwiseAbs().maxCoeff();
    if (farthest > format->maxCoordinate())
    {
      throw UserError(pending.path() + ": the format reaches " +
                      std::to_string(std::lround(format->maxCoordinate() / 1000)) +
                      " km, but the map reaches " + std::to_string(std::lround(farthest / 1000)) +
                      " km from its origin; are all poses of the trajectory right?");
    }
  }
  void requireGood() const
  {
    if (!file)
    {
      throw UserError(pending.path() + ": cannot be written: " +
                      (errno != 0 ? std::strerror(errno) : "unknown reason"));
    }
  }

  CloudDescription layout;
  std::unique_ptr<CloudFormat> format;
  PendingFile pending;
  std::ofstream file;
  CloudSummary summary;
};

MapCloudFile::MapCloudFile(const std::string& path, const CloudDescription& description)
    : impl_(std::make_unique<Impl>(path, description))
{
}
MapCloudFile::MapCloudFile(const std::string& path, bool normals)
    : MapCloudFile(path, CloudDescription{normals, Eigen::Vector3d::Zero(), std::nullopt, 0})
{
}
MapCloudFile::~MapCloudFile() = default;

void MapCloudFile::add(const MapPoints& points)
{
  Impl& m = *impl_;
  if (m.layout.normals && points.normals.size() != points.size())
  {
    throw std::invalid_argument("MapCloudFile: points without normals");
  }
  if (points.size() > m.format->maxPoints() - m.summary.count)
  {
    throw UserError(m.pending.path() + ": the format holds " +
                    std::to_string(m.format->maxPoints()) +
                    " points, but the map has more; set map_export.tile_size, or write .ply");
  }
  constexpr std::size_t buffer_size = 1 << 20;
  std::string buffer;
  for (std::size_t i = 0; i < points.size(); ++i)
  {
    const Eigen::Vector3d p = points.points[i].cast<double>();
    m.requireReach(p);
    m.summary.low = m.summary.low.cwiseMin(p);
    m.summary.high = m.summary.high.cwiseMax(p);
    m.format->append(points, i, buffer);
    if (buffer.size() >= buffer_size)
    {
      m.write(buffer);
      buffer.clear();
    }
  }
  m.write(buffer);
  m.summary.count += points.size();
}

std::size_t MapCloudFile::count() const
{
  return impl_->summary.count;
}

void MapCloudFile::close()
{
  Impl& m = *impl_;
  m.file.seekp(0);
  m.write(m.format->header(m.summary));
  m.file.close();
  m.requireGood();
  m.pending.commit();
}

void writeMapCloud(const MapPoints& points, const std::string& path, const Eigen::Vector3d& origin)
{
  const bool has_normals = points.size() > 0 && points.normals.size() == points.size();
  MapCloudFile file(path, CloudDescription{has_normals, origin, std::nullopt, 0});
  file.add(points);
  file.close();
}
}  // namespace dyslam
