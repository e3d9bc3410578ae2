// SPDX-License-Identifier: BSD-3-Clause
#include "RosCloud2.h"
#include "clouds/FieldNames.h"

namespace dyslam
{
/** Ouster's `intensity` counts photons without limit; its `reflectivity` is calibrated. */
void RosScanDecoder::fillIntensity(const Cloud2& cloud, Scan& scan)
{
  const PointField* field = cloud.findAny(intensity_names);
  const PointField* calibrated = cloud.find(calibrated_intensity_name);
  if (field == nullptr || scan.points.empty())
  {
    return;
  }
  std::vector<double> values = cloud.values(*field);
  const std::string& name = conventions_.intensityField(
      field->name, calibrated != nullptr ? calibrated->name : "", values);
  if (name != field->name)
  {
    field = cloud.find(name);
    if (field == nullptr)
    {
      throw UserError(cloud.place + ": lacks the field " + name + " that earlier scans have");
    }
    values = cloud.values(*field);
  }
  scan.intensity.reserve(values.size());
  for (const double value : values)
  {
    scan.intensity.push_back(static_cast<float>(value));
  }
}

const PointField* RosScanDecoder::timeField(const Cloud2& cloud)
{
  return cloud.findAny(time_names);
}

const PointField* RosScanDecoder::ringField(const Cloud2& cloud)
{
  return cloud.findAny(ring_names);
}

void RosScanDecoder::fillTimes(const Cloud2& cloud, Scan& scan)
{
  const PointField* field = timeField(cloud);
  if (field == nullptr || scan.points.empty())
  {
    return;
  }
  const bool is_integer = field->type->isInteger();
  conventions_.fillTimes(
      {field->name, is_integer, !is_integer && field->type->size == 4, cloud.values(*field)}, scan);
}

/** The ring of a point is the value of its field or, in an organised cloud, its row. */
void RosScanDecoder::fillRings(const Cloud2& cloud, Scan& scan)
{
  const PointField* field = ringField(cloud);
  const bool rows = rowsAreRings(cloud.height, cloud.width);
  if ((field == nullptr && !rows) || scan.points.empty())
  {
    return;
  }
  scan.ring.reserve(scan.size());
  for (std::size_t i = 0; i < scan.size(); ++i)
  {
    const double ring =
        field != nullptr ? cloud.value(*field, i) : static_cast<double>(i / cloud.width);
    scan.ring.push_back(ringNumber(ring));
  }
  conventions_.orderRings(field != nullptr ? "field " + field->name : "rows of the cloud", scan,
                          field == nullptr);
}
}  // namespace dyslam
