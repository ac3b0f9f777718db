// What the listeners by TCP share (http_listener.h, admin/rcon_listener.h): they take connections on one thread, and as
// many as they have room for.
//
// Boost.Asio takes seconds to compile, so only their sources include this.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <list>
#include <memory>
#include <string>
#include <utility>  // before Boost 1.74, which uses std::exchange without it

#include <boost/asio.hpp>

#include "server/ops/address.h"

namespace wobble::ops {

class Acceptor {
 public:
  // take: called on the thread that runs `context`. Destroying the socket closes it.
  using Take = std::function<void(boost::asio::ip::tcp::socket, const boost::asio::ip::address& from)>;
  Acceptor(boost::asio::io_context& context, Take take);

  // False with one line in `error` when the address cannot be listened on.
  [[nodiscard]] bool Open(const Address& address, std::string& error);
  [[nodiscard]] std::uint16_t ReadPort() const { return m_acceptor.local_endpoint().port(); }

 private:
  std::string Listen(const Address& address);
  void Accept();

  boost::asio::io_context& m_context;
  Take m_take;
  boost::asio::ip::tcp::acceptor m_acceptor;
  boost::asio::steady_timer m_pause;
};

// The connections that are open. A Connection has From(), its address; MayYield(), whether it may be closed to make
// room for a new one; and Close().
template <class Connection>
class Crowd {
 public:
  Crowd(std::size_t most, std::size_t mostPerAddress) : m_most(most), m_mostPerAddress(mostPerAddress) {}

  // Whether there is room for one more of this address, after closing the oldest that may yield.
  [[nodiscard]] bool MakeRoom(const boost::asio::ip::address& from) {
    const auto isOfAddress = [&](const auto& each) { return each->From() == from; };
    const auto ofAddress = std::count_if(m_open.begin(), m_open.end(), isOfAddress);
    if (static_cast<std::size_t>(ofAddress) >= m_mostPerAddress) return false;
    if (m_open.size() < m_most) return true;
    const auto oldest = std::find_if(m_open.begin(), m_open.end(), [](const auto& each) { return each->MayYield(); });
    if (oldest == m_open.end()) return false;
    (*oldest)->Close();
    m_open.erase(oldest);
    return true;
  }
  void Add(std::shared_ptr<Connection> connection) { m_open.push_back(std::move(connection)); }
  void Remove(const Connection* connection) {
    std::erase_if(m_open, [&](const auto& each) { return each.get() == connection; });
  }
  void Clear() { m_open.clear(); }

 private:
  std::size_t m_most;
  std::size_t m_mostPerAddress;
  std::list<std::shared_ptr<Connection>> m_open;  // the oldest first
};

}  // namespace wobble::ops
