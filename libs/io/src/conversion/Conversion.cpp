// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/io/Conversion.h>

#include <optional>

namespace dyslam
{
void ConversionOptions::describeConversion(OptionsVisitor& visitor)
{
  describeRange(visitor);
  visitor.integer("every_n", every_n, 1, 1000000,
                  "interval between converted scans; 1: every scan [scans]");
  visitor.flag("external_storage", external_storage, "write clouds in separate files");
  visitor.integer("compression_level", compression_level, 0, 9,
                  "level of the gzip compression: 0 none, 1 fast, 9 small");
}

Pose poseFromOption(const std::string& option, const std::string& text)
{
  if (text.empty())
  {
    return Pose::Identity();
  }
  const std::optional<Pose> pose = poseFromText(text);
  if (!pose)
  {
    throw UserError(option + " '" + text +
                    "': six numbers are needed: x y z [m] yaw pitch roll [deg]");
  }
  return *pose;
}
}  // namespace dyslam
