#include "server/base/log.h"

#include <fmt/chrono.h>
#include <spdlog/formatter.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <mutex>
#include <nlohmann/json.hpp>

namespace mirage {
namespace {

constexpr int kMostLinesASecond = 50;

struct About {
  std::uint64_t connection = 0;
  std::string address;
};
thread_local About about;

std::string_view text_of(const spdlog::string_view_t& view) { return {view.data(), view.size()}; }

class JsonFormatter final : public spdlog::formatter {
 public:
  void format(const spdlog::details::log_msg& line, spdlog::memory_buf_t& out) override {
    nlohmann::ordered_json j;
    const auto us =
        std::chrono::duration_cast<std::chrono::microseconds>(line.time.time_since_epoch()).count();
    j["time"] =
        fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:06d}Z", fmt::gmtime(us / 1'000'000), us % 1'000'000);
    j["level"] = text_of(spdlog::level::to_string_view(line.level));
    j["message"] = text_of(line.payload);
    if (about.connection != 0) {
      j["connection"] = about.connection;
      j["peer"] = about.address;
    }
    const std::string text =
        j.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
    out.append(text.data(), text.data() + text.size());
  }
  std::unique_ptr<spdlog::formatter> clone() const override {
    return std::make_unique<JsonFormatter>();
  }
};

class LimitedSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  explicit LimitedSink(std::shared_ptr<spdlog::sinks::sink> to) : to_(std::move(to)) {}

 private:
  void sink_it_(const spdlog::details::log_msg& line) override {
    const auto second = std::chrono::floor<std::chrono::seconds>(line.time);
    if (second != second_) {
      if (lines_ > kMostLinesASecond) {
        const std::string text =
            fmt::format("{} more lines within a second are left out", lines_ - kMostLinesASecond);
        to_->log({line.time, {}, line.logger_name, spdlog::level::warn, text});
      }
      second_ = second;
      lines_ = 0;
    }
    if (line.level < spdlog::level::err && ++lines_ > kMostLinesASecond) return;
    to_->log(line);
  }
  void flush_() override { to_->flush(); }
  void set_pattern_(const std::string& pattern) override { to_->set_pattern(pattern); }
  void set_formatter_(std::unique_ptr<spdlog::formatter> formatter) override {
    to_->set_formatter(std::move(formatter));
  }

  const std::shared_ptr<spdlog::sinks::sink> to_;
  std::chrono::sys_seconds second_{};
  int lines_ = 0;
};

}  // namespace

void set_up_log(LogFormat format) {
  const auto terminal = std::make_shared<spdlog::sinks::stderr_color_sink_mt>();
  const auto limited = std::make_shared<LimitedSink>(terminal);
  auto logger = std::make_shared<spdlog::logger>("mirage", limited);
  if (format == LogFormat::kJson) {
    logger->set_formatter(std::make_unique<JsonFormatter>());
  } else {
    logger->set_pattern("%H:%M:%S.%e %^%l%$ %v");
  }
  spdlog::set_default_logger(std::move(logger));
}

LogAbout::LogAbout(std::uint64_t connection, const std::string& address) {
  about = {connection, address};
}

LogAbout::~LogAbout() { about = {}; }

}  // namespace mirage
