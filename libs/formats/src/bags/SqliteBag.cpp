// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Words.h>
#include <sqlite3.h>

#include <algorithm>
#include <string_view>
#include <vector>

#include "BagFormats.h"
#include "Decompression.h"

namespace dyslam
{
namespace
{
constexpr std::string_view zstd_magic = "\x28\xB5\x2F\xFD";

struct CloseDatabase
{
  void operator()(sqlite3* database) const { sqlite3_close(database); }
};
struct CloseStatement
{
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};

/** One SQL query, row by row. */
class Query
{
 public:
  Query(sqlite3* database, const std::string& sql, const std::string& name)
      : database_(database), name_(name)
  {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database, sql.c_str(), -1, &statement, nullptr) != SQLITE_OK)
    {
      throw UserError(name + ": is not a ROS 2 bag: " + sqlite3_errmsg(database));
    }
    statement_.reset(statement);
  }

  [[nodiscard]] bool next()
  {
    const int code = sqlite3_step(statement_.get());
    if (code != SQLITE_ROW && code != SQLITE_DONE)
    {
      throw UserError(name_ + ": cannot be read further: " + sqlite3_errmsg(database_));
    }
    return code == SQLITE_ROW;
  }
  [[nodiscard]] std::int64_t integer(int column) const
  {
    return sqlite3_column_int64(statement_.get(), column);
  }
  [[nodiscard]] std::string text(int column) const
  {
    const unsigned char* value = sqlite3_column_text(statement_.get(), column);
    return value == nullptr ? "" : reinterpret_cast<const char*>(value);
  }
  /** Valid until the next row. */
  [[nodiscard]] std::string_view blob(int column) const
  {
    const void* value = sqlite3_column_blob(statement_.get(), column);
    const int size = sqlite3_column_bytes(statement_.get(), column);
    return {static_cast<const char*>(value), value == nullptr ? 0 : static_cast<std::size_t>(size)};
  }

 private:
  sqlite3* database_;
  std::string name_;
  std::unique_ptr<sqlite3_stmt, CloseStatement> statement_;
};

class SqliteBag : public Bag
{
 public:
  explicit SqliteBag(const BagFile& file) : name_(file.name)
  {
    (void)openBinary(file.path);
    sqlite3* database = nullptr;
    const int code = sqlite3_open_v2(file.path.c_str(), &database, SQLITE_OPEN_READONLY, nullptr);
    database_.reset(database);
    if (code != SQLITE_OK)
    {
      throw UserError(name_ + ": cannot be opened: " + sqlite3_errmsg(database));
    }
    Query topics(database, "SELECT id, name, type, serialization_format FROM topics ORDER BY id",
                 name_);
    while (topics.next())
    {
      BagTopic topic;
      topic.name = topics.text(1);
      topic.type = plainRosType(topics.text(2));
      const auto encoding = topics.text(3);  // a bag that was reindexed has none
      topic.encoding =
          encoding == "cdr" || encoding.empty() ? RosEncoding::cdr : RosEncoding::other;
      ids_.push_back(topics.integer(0));
      topics_.push_back(topic);
    }
    count();
  }

  [[nodiscard]] const std::vector<BagTopic>& topics() const override { return topics_; }

  void select(const std::vector<std::size_t>& topics) override
  {
    std::string ids;
    total_ = 0;
    for (const std::size_t topic : topics)
    {
      appendWord(ids, std::to_string(ids_.at(topic)), ",");
      total_ += topics_[topic].messages;
    }
    done_ = 0;
    query_ = std::make_unique<Query>(database_.get(),
                                     "SELECT id, topic_id, timestamp, data FROM messages WHERE "
                                     "topic_id IN (" +
                                         ids + ") ORDER BY timestamp, id",
                                     name_);
  }

  [[nodiscard]] bool next(BagMessage& message) override
  {
    if (!query_ || !query_->next())
    {
      return false;
    }
    ++done_;
    const auto id = std::find(ids_.begin(), ids_.end(), query_->integer(1));
    message.topic = static_cast<std::size_t>(id - ids_.begin());
    message.recorded = secondsOfNanoseconds(query_->integer(2));
    message.place = name_ + ": message " + std::to_string(query_->integer(0));
    message.data = query_->blob(3);
    if (message.data.substr(0, zstd_magic.size()) == zstd_magic)
    {
      unpacked_ = decompressed("zstd", message.data, 0, message.place);
      message.data = unpacked_;
    }
    return true;
  }

  [[nodiscard]] double progress() const override
  {
    return total_ == 0 ? 1.0 : static_cast<double>(done_) / static_cast<double>(total_);
  }
  [[nodiscard]] std::vector<std::string> warnings() const override { return {}; }

 private:
  void count()
  {
    Query counts(database_.get(),
                 "SELECT topic_id, COUNT(*), MIN(timestamp), MAX(timestamp) FROM messages GROUP BY "
                 "topic_id",
                 name_);
    while (counts.next())
    {
      const auto id = std::find(ids_.begin(), ids_.end(), counts.integer(0));
      if (id != ids_.end())
      {
        BagTopic& topic = topics_[static_cast<std::size_t>(id - ids_.begin())];
        topic.messages = static_cast<std::size_t>(counts.integer(1));
        topic.first = secondsOfNanoseconds(counts.integer(2));
        topic.last = secondsOfNanoseconds(counts.integer(3));
      }
    }
  }

  std::string name_;  //!< BagFile::name
  std::unique_ptr<sqlite3, CloseDatabase> database_;
  std::vector<BagTopic> topics_;
  std::vector<std::int64_t> ids_;  //!< the database's numbers of the topics
  std::unique_ptr<Query> query_;
  std::string unpacked_;
  std::size_t total_ = 0;
  std::size_t done_ = 0;
};
}  // namespace

std::unique_ptr<Bag> openSqliteBag(const BagFile& file)
{
  return std::make_unique<SqliteBag>(file);
}
}  // namespace dyslam
