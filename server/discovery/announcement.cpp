// Avahi has two libraries for the same: one asks its daemon by D-Bus, one is the responder itself. They differ in the
// names of types and functions only, so one template serves both.
//
// Both have a function avahi_entry_group_free, not the same one, and each calls its own by name: the loader gives both
// that of the library that is linked first, which is the responder's. So a client of the daemon that has a group cannot
// be freed. It is left as it is when the daemon goes, which is rare, and when the server ends.
#include "server/discovery/announcement.h"

#include <avahi-client/client.h>
#include <avahi-client/publish.h>
#include <avahi-common/alternative.h>
#include <avahi-common/error.h>
#include <avahi-common/malloc.h>
#include <avahi-common/simple-watch.h>
#include <avahi-common/strlst.h>
#include <avahi-core/core.h>
#include <avahi-core/log.h>
#include <avahi-core/publish.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace wobble::discovery {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kService = "_wobble._udp";
constexpr int kTurnMs = 100;  // until a stop or a new picture is seen
constexpr std::chrono::seconds kTryAgain{10};
constexpr int kMostNames = 20;  // "arena", "arena #2", ...

struct Notice {
  std::string name;
  std::uint16_t port = 0;
  std::vector<std::pair<std::string, std::string>> words;  // the TXT record
  bool operator==(const Notice&) const = default;
};

Notice MakeNotice(const protocol::ServerPicture& picture) {
  Notice notice{.name = picture.name,
                .port = picture.port,
                .words = {{"txtvers", "1"}, {"scene", picture.scene}, {"version", picture.version}}};
  for (const auto& [name, value] : picture.rules) {
    if (name == "key") notice.words.emplace_back(name, value);
  }
  return notice;
}

struct Daemon {
  using Host = AvahiClient;
  using State = AvahiClientState;
  using Group = AvahiEntryGroup;
  static constexpr const char* kWho = "Avahi's daemon";
  static Host* MakeHost(const AvahiPoll* poll, AvahiClientCallback callback, void* data, int* error) {
    return avahi_client_new(poll, AvahiClientFlags{}, callback, data, error);
  }
  template <class Publisher>
  static Group* MakeGroup(Host* host, Publisher* publisher) {
    return avahi_entry_group_new(
        host, [](Group*, AvahiEntryGroupState state, void* data) { static_cast<Publisher*>(data)->TakeState(state); },
        publisher);
  }
  static int Add(Host*, Group* group, const Notice& notice, AvahiStringList* words) {
    return avahi_entry_group_add_service_strlst(group, AVAHI_IF_UNSPEC, AVAHI_PROTO_UNSPEC, AvahiPublishFlags{},
                                                notice.name.c_str(), kService, nullptr, nullptr, notice.port, words);
  }
  static int Commit(Group* group) { return avahi_entry_group_commit(group); }
  static void Reset(Group* group) { avahi_entry_group_reset(group); }
  static void ChooseHostName(Host*) {}  // the daemon does
  static void Free(Host* host, Group* group) {
    if (group == nullptr) return avahi_client_free(host);
    avahi_entry_group_reset(group);
  }
};

struct Responder {
  using Host = AvahiServer;
  using State = AvahiServerState;
  using Group = AvahiSEntryGroup;
  static constexpr const char* kWho = "the server itself";
  static Host* MakeHost(const AvahiPoll* poll, AvahiServerCallback callback, void* data, int* error) {
    AvahiServerConfig config;
    avahi_server_config_init(&config);
    config.publish_hinfo = config.publish_workstation = config.publish_domain = config.enable_wide_area = 0;
    Host* host = avahi_server_new(poll, &config, callback, data, error);
    avahi_server_config_free(&config);
    return host;
  }
  template <class Publisher>
  static Group* MakeGroup(Host* host, Publisher* publisher) {
    return avahi_s_entry_group_new(
        host,
        [](Host*, Group*, AvahiEntryGroupState state, void* data) { static_cast<Publisher*>(data)->TakeState(state); },
        publisher);
  }
  static int Add(Host* host, Group* group, const Notice& notice, AvahiStringList* words) {
    return avahi_server_add_service_strlst(host, group, AVAHI_IF_UNSPEC, AVAHI_PROTO_UNSPEC, AvahiPublishFlags{},
                                           notice.name.c_str(), kService, nullptr, nullptr, notice.port, words);
  }
  static int Commit(Group* group) { return avahi_s_entry_group_commit(group); }
  static void Reset(Group* group) { avahi_s_entry_group_reset(group); }
  static void ChooseHostName(Host* host) {
    char* name = avahi_alternative_host_name(avahi_server_get_host_name(host));
    avahi_server_set_host_name(host, name);
    avahi_free(name);
  }
  static void Free(Host* host, Group*) { avahi_server_free(host); }
};

// Publishes one service. Avahi calls back on the thread that runs its poll, and from within Start.
template <class Api>
class Publisher {
 public:
  Publisher() = default;
  Publisher(const Publisher&) = delete;
  Publisher& operator=(const Publisher&) = delete;
  ~Publisher() { Stop(); }

  // False: Avahi, of this kind, is not there.
  bool Start(const AvahiPoll* poll, const Notice& notice) {
    Stop();
    m_notice = notice;
    int error = 0;
    m_host = Api::MakeHost(
        poll,
        [](typename Api::Host* host, typename Api::State state, void* data) {
          static_cast<Publisher*>(data)->TakeState(host, state);
        },
        this, &error);
    if (m_host == nullptr) m_error = avahi_strerror(error);
    return IsGood();
  }
  void Update(const Notice& notice) {
    m_notice = notice;
    if (m_group != nullptr) Publish(m_host);
  }
  [[nodiscard]] bool IsGood() const { return m_host != nullptr && m_error.empty(); }
  [[nodiscard]] const std::string& Error() const { return m_error; }

  // Of the host: the daemon's, or the own responder's.
  void TakeState(typename Api::Host* host, typename Api::State state) {
    switch (static_cast<int>(state)) {
      case AVAHI_SERVER_RUNNING:
        return Publish(host);
      case AVAHI_SERVER_COLLISION:
        Api::ChooseHostName(host);
        [[fallthrough]];
      case AVAHI_SERVER_REGISTERING:  // the machine's name is not certain
        if (m_group != nullptr) Api::Reset(m_group);
        return;
      case AVAHI_SERVER_FAILURE:
      case AVAHI_CLIENT_FAILURE:
        m_error = "Avahi has failed";
        return;
      default:
        return;
    }
  }
  // Of what is published.
  void TakeState(AvahiEntryGroupState state) {
    if (state == AVAHI_ENTRY_GROUP_ESTABLISHED) {
      spdlog::info("announced in the local network as \"{}\" by {}", m_notice.name, Api::kWho);
    } else if (state == AVAHI_ENTRY_GROUP_COLLISION) {
      Rename();
      Publish(m_host);
    } else if (state == AVAHI_ENTRY_GROUP_FAILURE) {
      m_error = "the service cannot be published";
    }
  }

 private:
  void Publish(typename Api::Host* host) {
    if (m_group == nullptr) m_group = Api::MakeGroup(host, this);
    if (m_group == nullptr) {
      m_error = "the service cannot be published";
      return;
    }
    Api::Reset(m_group);
    AvahiStringList* words = nullptr;
    for (const auto& [name, value] : m_notice.words) {
      words = avahi_string_list_add_pair(words, name.c_str(), value.c_str());
    }
    int result = Api::Add(host, m_group, m_notice, words);
    for (int i = 1; i < kMostNames && result == AVAHI_ERR_COLLISION; ++i) {
      Rename();
      result = Api::Add(host, m_group, m_notice, words);
    }
    avahi_string_list_free(words);
    if (result >= 0) result = Api::Commit(m_group);
    if (result < 0) m_error = avahi_strerror(result);
  }
  void Rename() {
    char* name = avahi_alternative_service_name(m_notice.name.c_str());
    m_notice.name = name;
    avahi_free(name);
  }
  void Stop() {
    m_error.clear();
    // The group goes with the host.
    if (m_host != nullptr) Api::Free(std::exchange(m_host, nullptr), std::exchange(m_group, nullptr));
  }

  Notice m_notice;
  typename Api::Host* m_host = nullptr;
  typename Api::Group* m_group = nullptr;
  std::string m_error;  // empty: all is well
};

}  // namespace

Announcement::Announcement(std::shared_ptr<transport::vestibule::PictureSlot> pictures)
    : m_pictures(std::move(pictures)), m_thread([this] { Run(); }) {}

Announcement::~Announcement() {
  m_isStopping = true;
  m_thread.join();
}

void Announcement::Run() {
  avahi_set_log_function([](AvahiLogLevel, const char* line) { spdlog::debug("Avahi: {}", line); });
  AvahiSimplePoll* poll = avahi_simple_poll_new();
  if (poll == nullptr) return;
  {
    Publisher<Daemon> daemon;
    Publisher<Responder> responder;
    Notice notice;
    Clock::time_point nextTry = Clock::now();
    bool hasWarned = false;
    while (!m_isStopping) {
      if (const auto picture = m_pictures->Take()) {
        Notice fresh = MakeNotice(*picture);
        if (fresh != notice) {
          notice = std::move(fresh);
          if (daemon.IsGood()) daemon.Update(notice);
          if (responder.IsGood()) responder.Update(notice);
        }
      }
      if (notice.port != 0 && !daemon.IsGood() && !responder.IsGood() && Clock::now() >= nextTry) {
        nextTry = Clock::now() + kTryAgain;
        const AvahiPoll* api = avahi_simple_poll_get(poll);
        if (!daemon.Start(api, notice) && !responder.Start(api, notice) && !std::exchange(hasWarned, true)) {
          spdlog::warn("--announce: {}; tried again every {} s", responder.Error(), kTryAgain.count());
        }
      }
      if (avahi_simple_poll_iterate(poll, kTurnMs) != 0) break;
    }
  }
  avahi_simple_poll_free(poll);
}

}  // namespace wobble::discovery
