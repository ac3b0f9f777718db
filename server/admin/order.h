// An order while it is carried out, and what the files of orders share. Only they include this.
#pragma once

#include <charconv>
#include <cstdint>
#include <deque>
#include <optional>
#include <string>

#include "server/admin/orders.h"

namespace wobble::admin {

struct Order {
  Realm realm;
  Issuer issuer;
  double now = 0;
  std::deque<std::string> words = {};  // behind its name

  [[nodiscard]] bool IsAtEnd() const { return words.empty(); }
  // "" at the end.
  std::string TakeWord();
  bool TakeIf(const char* word);
  // What is left, in one line.
  std::string TakeRest();
};

[[nodiscard]] Answer Done(std::string line);
[[nodiscard]] Answer Refuse(std::string line);

template <class Number>
[[nodiscard]] std::optional<Number> ParseNumber(const std::string& text) {
  Number number{};
  const auto [end, result] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool isWhole = result == std::errc{} && end == text.data() + text.size() && !text.empty();
  return isWhole ? std::optional(number) : std::nullopt;
}

// A word of the issuer, as answers quote it.
[[nodiscard]] std::string Quote(const std::string& word);
// "until 2026-11-23 12:00 UTC"; until: s since 1970; 0: for good.
[[nodiscard]] std::string FormatEnd(std::uint64_t until);
// What the word behind "for" says, s; nullopt with the reason in `refusal` when it is no time.
[[nodiscard]] std::optional<std::uint64_t> TakeSpan(Order& order, Answer& refusal);
// The player that the next word names; nullopt with the reason in `refusal` when there is none, or none below the
// issuer's rank.
[[nodiscard]] std::optional<server::Server::Player> TakePlayer(Order& order, Answer& refusal);

// ban_orders.cpp
[[nodiscard]] Answer AddBan(Order& order);
[[nodiscard]] Answer ListBans(Order& order);
[[nodiscard]] Answer LiftBan(Order& order);

// invite_orders.cpp
[[nodiscard]] Answer MakeInvite(Order& order);
[[nodiscard]] Answer ListInvites(Order& order);
[[nodiscard]] Answer RevokeInvite(Order& order);

}  // namespace wobble::admin
