// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/SmoothedObject.h>
#include <gtest/gtest.h>

#include <vector>

namespace dyslam
{
namespace
{
SmoothedObject objectAt(std::size_t scan, int id)
{
  SmoothedObject object;
  object.scan = scan;
  object.id = id;
  return object;
}

TEST(SmoothedObject, IsFoundByScanAndId)
{
  const std::vector<SmoothedObject> objects{objectAt(2, 1), objectAt(2, 5), objectAt(3, 0),
                                            objectAt(7, 5)};
  for (const SmoothedObject& object : objects)
  {
    EXPECT_EQ(findSmoothed(objects, object.scan, object.id), &object);
  }
  EXPECT_EQ(findSmoothed(objects, 2, 0), nullptr);
  EXPECT_EQ(findSmoothed(objects, 2, 3), nullptr) << "another object has a higher id in this scan";
  EXPECT_EQ(findSmoothed(objects, 3, 5), nullptr) << "only in other scans";
  EXPECT_EQ(findSmoothed(objects, 8, 5), nullptr);
  EXPECT_EQ(findSmoothed({}, 2, 1), nullptr);
}
}  // namespace
}  // namespace dyslam
