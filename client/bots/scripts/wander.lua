-- Walks like a new player: in one direction for a while, now and then a jump or a puff, and back to the middle before
-- the edge of the arena.
local TURN_BACK = 6      -- metres from the middle
local WALK = { 0.4, 2 }  -- seconds in one direction, least and most

local function heading(bot)
  local x, y = bot:position()
  if x and math.sqrt(x * x + y * y) > TURN_BACK then
    return math.atan(-y, -x) + (bot:random() - 0.5)  -- to the middle, give or take 30 degrees
  end
  return 2 * math.pi * bot:random()
end

function run(bot)
  while true do
    local angle = heading(bot)
    bot:move(math.cos(angle), math.sin(angle))
    local mood = bot:random()
    if mood < 0.35 then bot:jump() end
    bot:puff(mood > 0.85)
    bot:stiffen(mood > 0.6 and mood < 0.7)
    bot:wait(WALK[1] + (WALK[2] - WALK[1]) * bot:random())
  end
end
