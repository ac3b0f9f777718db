// Runs a plan: starts its programs, starts again what dies, shows how it goes, and ends all of it together.
#pragma once

#include <functional>
#include <optional>

#include "client/host/plan.h"

namespace wobble::host {

// A new plan in place of the present one, once for each change; nullopt: there is none.
using TakePlan = std::function<std::optional<Plan>()>;

// Until the time is up, stopAsked is true, or no world is left. A program that dies is started again by the rules of
// keeper.h on the port that it had, and the others go on. A program that cannot be started at first with its options
// ends all of it. Returns the exit code: 0 when nothing failed (what came back has not), 2 when a program could not
// start as told to, else 1.
[[nodiscard]] int RunFleet(const Plan& plan, const std::function<bool()>& stopAsked, const TakePlan& takePlan = {});

}  // namespace wobble::host
