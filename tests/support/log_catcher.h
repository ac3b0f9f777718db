// What a server logs, for tests.
#pragma once

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include <memory>
#include <sstream>
#include <string>

namespace wobble::test {

// Everything that is logged while it lives.
class LogCatcher {
 public:
  LogCatcher() : m_before(spdlog::default_logger()) {
    auto logger = std::make_shared<spdlog::logger>("caught", std::make_shared<spdlog::sinks::ostream_sink_st>(m_text));
    logger->set_level(spdlog::level::trace);
    logger->set_pattern("%v");
    spdlog::set_default_logger(logger);
  }
  ~LogCatcher() { spdlog::set_default_logger(m_before); }
  [[nodiscard]] std::string Text() const { return m_text.str(); }

 private:
  std::ostringstream m_text;
  std::shared_ptr<spdlog::logger> m_before;
};

}  // namespace wobble::test
