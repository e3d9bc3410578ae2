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
  catch (const std::exception&)  // torch's own tells a page
  {
    throw UserError(path +
                    ": cannot be written; mend the folder, its permissions or the free space");
  }
  pending.commit();
}
}  // namespace dyslam
