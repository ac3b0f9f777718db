// Who may come in: what the door asks once an address is proved.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/transport/admission.h"
#include "protocol/transport/vestibule/handshake.h"

namespace wobble::transport::vestibule {

struct Judgement {
  Refusal refusal = Refusal::kNone;
  Admission admission = {};  // of one who is let in
  std::vector<std::uint8_t> ticket =
      {};  // for it, to come back with as a token; at most kMaxCredentialBytes; empty: none
};

// Called on the door's thread.
class Judge {
 public:
  Judge() = default;
  Judge(const Judge&) = delete;
  Judge& operator=(const Judge&) = delete;
  virtual ~Judge() = default;

  // Whether clients without a credential are refused.
  [[nodiscard]] virtual bool WantsCredential() const = 0;
  // The address for which the client counts: `from`, or what a gateway that proves itself says. Takes the gateway's
  // introduction off the credential.
  [[nodiscard]] virtual NetAddress FindSource(Credential& credential, const NetAddress& from) = 0;
  // Not asked for a subnet that has guessed too often.
  [[nodiscard]] virtual Judgement Decide(const Credential& credential, const NetAddress& source) = 0;
};

}  // namespace wobble::transport::vestibule
