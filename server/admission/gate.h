// Who may come into this server, and as what: password, tokens, invites, the owner's key and bans.
//
// The vestibule's thread asks it, and the administrator's commands change it meanwhile; a mutex is held for
// microseconds, and where a use of an invite is counted, for the write of its file.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "protocol/transport/vestibule/judge.h"
#include "protocol/transport/vestibule/token.h"
#include "server/admission/bans.h"
#include "server/admission/invites.h"

namespace wobble::admission {

// Without password, token key and isByInviteOnly everybody may come in.
struct GateSettings {
  transport::vestibule::Key secretKey{};             // of the server
  std::string password;                              // empty: none
  std::optional<transport::vestibule::Key> token;    // that connect tokens are sealed with
  std::optional<transport::vestibule::Key> owner;    // whoever shows it is an owner
  std::optional<transport::vestibule::Key> gateway;  // that gateways' introductions are sealed with
  bool isByInviteOnly = false;
  bool givesTicketsToAll = false;               // so that each who comes back is known again (Admission::identity)
  std::function<std::uint64_t()> readUnixTime;  // s since 1970
  transport::vestibule::RandomSource random = transport::vestibule::FillRandomly;
};

class Gate final : public transport::vestibule::Judge {
 public:
  Gate(GateSettings settings, Bans bans, Invites invites);

  [[nodiscard]] bool WantsCredential() const override { return m_wantsCredential; }
  [[nodiscard]] transport::NetAddress FindSource(transport::vestibule::Credential& credential,
                                                 const transport::NetAddress& from) override;
  [[nodiscard]] transport::vestibule::Judgement Decide(const transport::vestibule::Credential& credential,
                                                       const transport::NetAddress& source) override;

  // Takes the password, the keys and what is asked for from these settings, which have no secretKey and no functions,
  // and reads bans and invites again. From any thread. False with one line in `error`, and nothing has changed.
  [[nodiscard]] bool Reload(GateSettings settings, std::string& error);

  // nullopt: this server has no owner. From the thread that calls Reload.
  [[nodiscard]] const std::optional<transport::vestibule::Key>& OwnerKey() const { return m_settings.owner; }

  // For the administrator, from any thread. `change` runs with the lock held; now: s since 1970.
  template <class Change>
  auto ChangeBans(const Change& change) {
    const std::lock_guard lock(m_mutex);
    return change(m_bans, m_settings.readUnixTime());
  }
  template <class Change>
  auto ChangeInvites(const Change& change) {
    const std::lock_guard lock(m_mutex);
    return change(m_invites, m_settings.readUnixTime(), m_settings.random);
  }

 private:
  using TicketNumber = std::array<std::uint8_t, 16>;  // all zeros: none
  // nullopt: the credential does not hold. number: of the ticket that it is, if it is one.
  [[nodiscard]] std::optional<transport::Admission> FindAdmission(const transport::vestibule::Credential& credential,
                                                                  TicketNumber& number);
  [[nodiscard]] std::optional<transport::Admission> TakeConnectToken(std::span<const std::uint8_t> bytes);
  [[nodiscard]] std::optional<transport::Admission> TakeTicket(std::span<const std::uint8_t> bytes,
                                                               TicketNumber& number) const;
  [[nodiscard]] std::vector<std::uint8_t> MakeTicket(const TicketNumber& number,
                                                     const transport::Admission& admission) const;

  GateSettings m_settings;
  std::atomic<bool> m_wantsCredential;
  transport::vestibule::Key m_publicKey{};
  transport::vestibule::Key m_ticketKey{};
  std::uint64_t m_startedAt;  // s since 1970

  std::mutex m_mutex;  // over m_settings, which Reload changes, and what follows
  Bans m_bans;
  Invites m_invites;
  std::map<std::array<std::uint8_t, 16>, std::uint64_t> m_spent;  // connect tokens by number, until they expire
};

}  // namespace wobble::admission
