// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/ExternalFiles.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/io/RawlogStream.h>
#include <mrpt/maps/registerAllClasses.h>
#include <mrpt/obs/CActionCollection.h>
#include <mrpt/obs/CRawlog.h>
#include <mrpt/obs/CSensoryFrame.h>
#include <mrpt/obs/registerAllClasses.h>

#include <filesystem>
#include <utility>

#include "GzInput.h"
#include "MrptErrors.h"
#include "RawlogObjects.h"

namespace dyslam
{
namespace
{
const char* const advice = "give an MRPT rawlog, or make one with kitti2rawlog or scans2rawlog";

std::string ownFolderOf(const std::string& path)
{
  const std::string parent = std::filesystem::path(path).parent_path().string();
  return parent.empty() ? "." : parent;
}

/** The path, unless it is that of a recording that the converters read. */
const std::string& checked(const std::string& path)
{
  const std::string other = conversionAdvice(path);
  if (!other.empty())
  {
    throw UserError(path + ": " + other);
  }
  return path;
}
}  // namespace

RawlogStream::RawlogStream(const std::string& path, std::function<bool()> stop)
    : path_(checked(path)),
      external_folder_(externalFolderOf(path).value_or(ownFolderOf(path))),
      file_(std::make_unique<GzInput>(path, std::move(stop))),
      objects_in_(std::make_unique<RawlogObjects>(*file_))
{
  if (file_->fileSize() == 0 && !file_->isStopped())
  {
    throw UserError(path + ": is empty; " + advice);
  }
  mrpt::obs::registerAllClasses_mrpt_obs();
  mrpt::maps::registerAllClasses_mrpt_maps();
}
RawlogStream::~RawlogStream() = default;
RawlogStream::RawlogStream(RawlogStream&&) noexcept = default;
RawlogStream& RawlogStream::operator=(RawlogStream&&) noexcept = default;

double RawlogStream::progress() const
{
  return file_->progress();
}

bool RawlogStream::isStopped() const
{
  return file_->isStopped();
}

void RawlogStream::failReading(const std::string& reason) const
{
  if (!file_->readError().empty())
  {
    throw UserError(path_ + ": cannot be read to its end, after " + counted(objects_, "object") +
                    ": " + file_->readError() + "; check the disk, or copy the file again");
  }
  if (objects_ == 0)
  {
    throw UserError(path_ + ": is not a rawlog, or is damaged in its first object" +
                    (file_->broken() ? " (the compressed data are broken)" : "") +
                    (file_->cut() ? " (the file ends there)" : "") +
                    (reason.empty() ? "" : ": " + reason) + "; " + advice);
  }
  const std::string count = counted(objects_, "object");
  if (file_->broken() || (!file_->cut() && file_->checkMember()))
  {
    throw UserError(path_ + ": the compressed data are damaged after " + count +
                    "; copy or record the file again");
  }
  if (file_->cut())
  {
    throw UserError(path_ + ": is cut short: the file ends within an object, after " +
                    std::to_string(objects_) + (objects_ == 1 ? " whole one" : " whole ones") +
                    "; copy or record it again");
  }
  throw UserError(path_ + ": is damaged after " + count + ": " + reason +
                  "; copy or record it again");
}

void RawlogStream::readObject()
{
  const mrpt::rtti::TRuntimeClassId* id = nullptr;
  try
  {
    id = objects_in_->next(queue_);
  }
  catch (const NewerMrpt& error)
  {
    if (file_->readError().empty() && !file_->cut() && !file_->checkMember())
    {
      throw UserError(path_ + ": has " + error.what() + "; " + newer_mrpt_advice);
    }
    failReading(error.what());
  }
  catch (const std::exception& error)
  {
    if (file_->isStopped())
    {
      return;  // within an object
    }
    failReading(messageOf(error));
  }
  if (id == nullptr)
  {
    ++objects_;
    return;
  }
  const std::string name = id->className;
  if (id == CLASS_ID_NAMESPACE(CRawlog, mrpt::obs))
  {
    throw UserError(path_ + ": holds a CRawlog as one object; save it again with rawlog-edit");
  }
  if (!id->derivedFrom(CLASS_ID_NAMESPACE(CObservation, mrpt::obs)) &&
      id != CLASS_ID_NAMESPACE(CSensoryFrame, mrpt::obs) &&
      id != CLASS_ID_NAMESPACE(CActionCollection, mrpt::obs))
  {
    if (objects_ == 0)
    {
      throw UserError(path_ + ": is not a rawlog: it holds a " + name + "; " + advice);
    }
    failReading("it holds a " + name);
  }
  ++objects_;
}

const std::map<std::string, std::size_t>& RawlogStream::leftOut() const
{
  return objects_in_->leftOut();
}

std::vector<std::string> RawlogStream::warnings() const
{
  std::vector<std::string> lines;
  for (const auto& [name, count] : leftOut())
  {
    lines.push_back(path_ + ": " + counted(count, "observation") + " of class '" + name +
                    "', which MRPT 2.5.8 does not have, left out");
  }
  if (file_->restAt())
  {
    lines.push_back(path_ + ": is not read from byte " + std::to_string(*file_->restAt()) + " of " +
                    std::to_string(file_->fileSize()) +
                    " on, where no gzip data begin; if scans are missing, the file is damaged "
                    "there: copy or record it again");
  }
  return lines;
}

mrpt::obs::CObservation::Ptr RawlogStream::next()
{
  while (queue_.empty())
  {
    if (file_->isStopped())
    {
      return nullptr;
    }
    if (objects_in_->atEnd())
    {
      if (!file_->isStopped() && (file_->cut() || file_->broken() || !file_->readError().empty()))
      {
        failReading("");
      }
      return nullptr;
    }
    readObject();
  }
  auto observation = queue_.front();
  queue_.pop_front();
  return observation;
}
}  // namespace dyslam
