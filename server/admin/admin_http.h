// Orders over HTTP: POST /orders with the order as its body and the owner's key as `Authorization: Bearer KEY`. Not
// encrypted: for this machine, or a private network.
#pragma once

#include <memory>
#include <string>

#include "protocol/transport/vestibule/keys.h"
#include "server/admin/order_queue.h"
#include "server/ops/http_listener.h"

namespace wobble::admin {

// queue: outlives the listener. Null with one line in `error`.
[[nodiscard]] std::unique_ptr<ops::HttpListener> ListenForOrders(const ops::Address& address,
                                                                 const transport::vestibule::Key& ownerKey,
                                                                 OrderQueue& queue, std::string& error);

}  // namespace wobble::admin
