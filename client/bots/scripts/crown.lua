-- Plays crown: runs after the crown and grabs it, pushes who wears it, and runs from the others while it wears it itself.
-- Load: hands that hold and let go, pushes, and a crowd that chases.
local REACH = 2          -- metres from which it grabs and pushes
local EDGE = 7           -- metres from the middle, along x and y; the walls stand at 8.6 m

local function run_to(bot, x, y)
  local own_x, own_y = bot:position()
  local angle = math.atan(y - own_y, x - own_x)
  bot:move(math.cos(angle), math.sin(angle))
end

-- Away from all players who are near, the nearer the more, and from the walls.
local function flee(bot)
  local x, y = bot:position()
  local dx, dy = -0.02 * x, -0.02 * y
  for _, other in ipairs(bot:near(6)) do
    if other.name then
      local share = 1 / math.max(0.5, other.distance) ^ 2
      dx = dx + share * (x - other.x)
      dy = dy + share * (y - other.y)
    end
  end
  if math.abs(x) > EDGE then dx = -x end
  if math.abs(y) > EDGE then dy = -y end
  run_to(bot, x + dx, y + dy)
end

local function chase(bot, crown, bearer)
  run_to(bot, crown.x + 0.2 * (crown.vx or 0), crown.y + 0.2 * (crown.vy or 0))
  if crown.distance > REACH then return bot:release() end
  if bearer and bot:random() < 0.4 then
    bot:push(bearer)
  else
    bot:release()
    bot:wait(0.05)  -- a hand that closes anew
    bot:grab(crown.body)
  end
end

function run(bot)
  while true do
    local game = bot:game()
    local crown = game and game.object
    if not crown or not bot:position() then
      bot:move(0, 0)
    elseif game.bearer == bot:body() then
      flee(bot)
    else
      chase(bot, crown, game.bearer)
      if bot:random() < 0.03 then bot:jump() end
    end
    bot:wait(0.15 + 0.15 * bot:random())  -- a person's reaction time
  end
end
