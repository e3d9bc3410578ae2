// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/nets/SaveArchive.h>

namespace dyslam
{
void saveArchive(torch::serialize::OutputArchive& archive, const std::string& path)
{
  PendingFile pending(path);
  try
  {
    archive.save_to(pending.temporary());
  }
  catch (const std::exception&)  // torch's message contains a stack trace
  {
    throw UserError(path +
                    ": cannot be written; check the folder, its permissions and the free space");
  }
  pending.commit();
}
}  // namespace dyslam
