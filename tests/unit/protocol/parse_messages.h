// Parses bytes as a message of either side or a blueprint and, when that succeeds, reads every field of it.
//
// AddressSanitizer then sees whatever verification should not have let through.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>

#include "protocol/messages.h"

namespace wobble::protocol::parsing {

// Read adds everything to this, so that no read is optimised away.
inline volatile std::uint64_t g_read = 0;

inline void Touch(std::uint64_t value) { g_read = g_read + value; }
inline void Touch(const wire::Vec3& v) { Touch(static_cast<std::uint64_t>(std::isfinite(v.x() + v.y() + v.z()))); }
inline void Touch(const flatbuffers::String& text) {
  for (const char c : text) Touch(static_cast<std::uint8_t>(c));
  EXPECT_EQ(text.c_str()[text.size()], '\0');
}

inline void ExpectFinite(const wire::Vec3& v) {
  EXPECT_TRUE(std::isfinite(v.x()) && std::isfinite(v.y()) && std::isfinite(v.z()));
}

inline void Read(const wire::Goodbye& goodbye) {
  Touch(*goodbye.detail());
  EXPECT_STRNE(Name(goodbye.reason()), "unknown reason");
}

inline void Read(const wire::ClientMessage& message) {
  if (const auto* hello = message.body_as_Hello()) {
    Touch(hello->protocol_version());
    Touch(hello->schema_hash());
    Touch(*hello->name());
    EXPECT_LE(hello->name()->size(), kMaxNameBytes);
    EXPECT_LE(hello->role(), wire::Role::MAX);
  } else if (const auto* input = message.body_as_Input()) {
    EXPECT_LE(input->frames()->size(), kMaxInputFrames);
    EXPECT_GT(input->frames()->size(), 0U);
    for (const wire::InputFrame* frame : *input->frames()) {
      Touch(frame->tick());
      EXPECT_GE(frame->move_x(), -127);
      EXPECT_GE(frame->move_y(), -127);
      EXPECT_LE(frame->buttons(), 7);
    }
    Touch(input->acked_sequence());
    Touch(input->acked_history());
    if (input->hand() != nullptr) ExpectFinite(input->hand()->target());
  } else if (const auto* push = message.body_as_Push()) {
    ExpectFinite(*push->direction());
  } else if (const auto* cut = message.body_as_Cut()) {
    for (const wire::Vec3* place : {cut->eye(), cut->from(), cut->to()}) ExpectFinite(*place);
  } else if (const auto* inspect = message.body_as_Inspect()) {
    Touch(inspect->body());
  } else if (const auto* tune = message.body_as_Tune()) {
    EXPECT_LE(tune->kind(), wire::TuneKind::MAX);
    ExpectFinite(*tune->value());
  } else if (const auto* build = message.body_as_Build()) {
    EXPECT_LE(build->kind(), wire::BuildKind::MAX);
    ExpectFinite(*build->at());
    for (const float value : {build->mass(), build->stiffness(), build->damping(), build->rest_length()}) {
      EXPECT_TRUE(std::isfinite(value));
    }
  } else if (const auto* order = message.body_as_Order()) {
    Touch(*order->line());
    EXPECT_LE(order->line()->size(), kMaxOrderBytes);
  } else if (const auto* say = message.body_as_Say()) {
    Touch(*say->text());
    EXPECT_LE(say->text()->size(), kMaxSaidBytes);
  } else if (const auto* rename = message.body_as_Rename()) {
    Touch(*rename->name());
    EXPECT_LE(rename->name()->size(), kMaxNameBytes);
  } else if (const auto* emote = message.body_as_Emote()) {
    EXPECT_LE(emote->kind(), wire::EmoteKind::MAX);
  } else if (const auto* goodbye = message.body_as_Goodbye()) {
    Read(*goodbye);
  } else {
    ADD_FAILURE() << "ok without a body";
  }
}

inline void Read(const wire::ServerMessage& message) {
  if (const auto* welcome = message.body_as_Welcome()) {
    Touch(welcome->client_id() + welcome->own_body() + welcome->tick());
    EXPECT_GT(welcome->tick_hz(), 0);
    EXPECT_GT(welcome->snapshot_hz(), 0);
    EXPECT_LE(welcome->blueprint_count(), kMaxBlueprints);
    Touch(*welcome->scene());
    if (welcome->description() != nullptr) Touch(*welcome->description());
    EXPECT_LE(welcome->talk(), 3);
    for (const wire::HeightField* field : *welcome->height_fields()) {
      EXPECT_LE(field->columns(), kMaxFieldNodes);
      EXPECT_GE(field->rows(), 2);
      EXPECT_TRUE(std::isfinite(field->corner().z() + field->low() + field->step() * 65535.0F));
    }
    for (const wire::Obstacle* obstacle : *welcome->obstacles()) {
      EXPECT_LE(obstacle->kind(), wire::ObstacleKind::MAX);
      EXPECT_TRUE(std::isfinite(obstacle->radius()));
      Touch(obstacle->a());
      Touch(obstacle->b());
    }
  } else if (const auto* chunk = message.body_as_BlueprintChunk()) {
    Touch(chunk->blueprint() + chunk->hash());
    EXPECT_LE(chunk->total(), kMaxBlueprintBytes);
    EXPECT_LE(std::uint64_t{chunk->offset()} + chunk->bytes()->size(), chunk->total());
    EXPECT_LT(chunk->generation(), kGenerations);
    for (const std::uint8_t byte : *chunk->bytes()) Touch(byte);
  } else if (const auto* rows = message.body_as_HeightRows()) {
    EXPECT_LE(rows->heights()->size(), kMaxRowsHeights);
    for (const std::uint16_t height : *rows->heights()) Touch(height);
  } else if (const auto* event = message.body_as_Event()) {
    EXPECT_LE(event->kind(), wire::EventKind::MAX);
    Touch(event->tick() + event->client_id() + event->body());
    EXPECT_LE(event->emote(), wire::EmoteKind::MAX);
    Touch(*event->name());
  } else if (const auto* tuning = message.body_as_Tuning()) {
    ExpectFinite(*tuning->gravity());
    EXPECT_TRUE(tuning->time_rate() > 0 && tuning->time_rate() <= 1 && tuning->stiffness() > 0);
  } else if (const auto* forces = message.body_as_Forces()) {
    EXPECT_GT(forces->stride(), 0);
    for (const wire::ForceSet* set : *forces->sets()) {
      EXPECT_LE(set->kind(), wire::ForceKind::MAX);
      EXPECT_LE(set->values()->size(), 3 * kMaxShownForces);
      for (const std::int8_t value : *set->values()) Touch(static_cast<std::uint8_t>(value));
    }
  } else if (const auto* board = message.body_as_Scoreboard()) {
    EXPECT_LE(board->phase(), wire::GamePhase::MAX);
    for (const wire::Score* score : *board->scores()) Touch(score->points());
    if (board->seats() != nullptr) {
      EXPECT_EQ(board->seats()->size(), board->scores()->size());
      for (const wire::Seat* seat : *board->seats()) EXPECT_LE(seat->side(), kSides);
    }
    if (board->sides() != nullptr) {
      EXPECT_EQ(board->sides()->size(), kSides);
    }
    EXPECT_LE(board->winning_side(), kSides);
  } else if (const auto* notice = message.body_as_Notice()) {
    EXPECT_LE(notice->text()->size(), kMaxNoticeBytes);
    Touch(*notice->text());
  } else if (const auto* next = message.body_as_NextScene()) {
    Touch(*next->scene());
  } else if (const auto* goodbye = message.body_as_Goodbye()) {
    Read(*goodbye);
  } else {
    ADD_FAILURE() << "ok without a body";
  }
}

inline void Read(const wire::Blueprint& blueprint) {
  Touch(*blueprint.name());
  EXPECT_TRUE(blueprint.size() > 0 && std::isfinite(blueprint.size()));
  EXPECT_LE(blueprint.rest()->size(), kMaxBodyVertices);
  for (const wire::Vec3* vertex : *blueprint.rest()) ExpectFinite(*vertex);
  if (blueprint.particles() != nullptr) {
    EXPECT_EQ(blueprint.particles()->size(), blueprint.rest()->size());
    for (const wire::ParticleTag* tag : *blueprint.particles()) EXPECT_TRUE(std::isfinite(tag->mass()));
  }
  if (blueprint.springs() != nullptr) {
    EXPECT_EQ(blueprint.springs()->size(), blueprint.edges() == nullptr ? 0 : blueprint.edges()->size());
    for (const wire::SpringTag* tag : *blueprint.springs()) EXPECT_TRUE(std::isfinite(tag->stiffness()));
  }
  for (const wire::Face* face : *blueprint.faces()) {
    EXPECT_LT(std::max({face->a(), face->b(), face->c()}), blueprint.rest()->size());
  }
  if (blueprint.edges() != nullptr) {
    EXPECT_LE(blueprint.edges()->size(), kMaxBlueprintEdges);
    for (const wire::Edge* edge : *blueprint.edges()) {
      EXPECT_LT(std::max(edge->a(), edge->b()), blueprint.rest()->size());
    }
  }
}

// The three parsers under one name; each sets its message only when the result is kOk.
inline ParseResult Parse(std::span<const std::uint8_t> bytes, const wire::ClientMessage*& message) {
  return ParseClientMessage(bytes, message);
}
inline ParseResult Parse(std::span<const std::uint8_t> bytes, const wire::ServerMessage*& message) {
  return ParseServerMessage(bytes, message);
}
inline ParseResult Parse(std::span<const std::uint8_t> bytes, const wire::Blueprint*& message) {
  return ParseBlueprint(bytes, message);
}

template <class Root>
ParseResult ParseAndRead(std::span<const std::uint8_t> bytes) {
  const Root* message = nullptr;
  const ParseResult result = Parse(bytes, message);
  EXPECT_EQ(message != nullptr, result == ParseResult::kOk) << Name(result);
  if (message != nullptr) Read(*message);
  return result;
}

inline ParseResult ParseAs(char side, std::span<const std::uint8_t> bytes) {
  if (side == 'c') return ParseAndRead<wire::ClientMessage>(bytes);
  if (side == 's') return ParseAndRead<wire::ServerMessage>(bytes);
  return ParseAndRead<wire::Blueprint>(bytes);
}

}  // namespace wobble::protocol::parsing
