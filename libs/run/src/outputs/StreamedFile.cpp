// SPDX-License-Identifier: BSD-3-Clause
#include "StreamedFile.h"

#include <dyslam/base/Error.h>

#include <filesystem>
#include <system_error>

namespace dyslam
{
void StreamedFile::open(const std::string& path, const std::string& header)
{
  pending_.emplace(path);
  file_.open(pending_->temporary());
  if (!file_)
  {
    throw UserError(path + ": cannot be written; choose another --output or fix its permissions");
  }
  write(header);
  requireWritten(waiting_.empty());
}

void StreamedFile::write(const std::string& text)
{
  waiting_ += text;
  (void)writeWaiting();
}

void StreamedFile::exchangeState(const std::string& path, StateArchive& archive)
{
  archive(size_, waiting_);
  if (!archive.isLoading())
  {
    pending_->keep();  // the state needs the file
    return;
  }
  pending_.emplace(path);
  pending_->keep();
  cutPending(*pending_, size_);
  file_.open(pending_->temporary(), std::ios::app);
}

void StreamedFile::close()
{
  bool is_written = writeWaiting();
  file_.close();
  is_written = is_written && file_;
  requireWritten(is_written);
  pending_->commit();
}

bool StreamedFile::writeWaiting()
{
  if (!file_)
  {
    reopen();
  }
  file_ << waiting_ << std::flush;
  if (!file_)
  {
    return false;
  }
  size_ += waiting_.size();
  waiting_.clear();
  return true;
}

void StreamedFile::reopen()
{
  file_.close();
  file_.clear();
  std::error_code error;
  std::filesystem::resize_file(pending_->temporary(), size_, error);
  if (error)
  {
    file_.setstate(std::ios::failbit);
    return;
  }
  file_.open(pending_->temporary(), std::ios::app);
}

void StreamedFile::requireWritten(bool is_written) const
{
  if (!is_written)
  {
    throw UserError(pending_->path() + ": not everything could be written; is the disk full?");
  }
}
}  // namespace dyslam
