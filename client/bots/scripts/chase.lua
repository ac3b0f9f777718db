-- Follows the nearest player, or the nearest body where no player is near, and jumps into it. Load: crowds, collisions,
-- and bodies that press on each other.
local SIGHT = 12         -- metres
local LEAP = 2.5         -- metres; jumps from this distance
local LEAD = 0.2         -- seconds by which it aims ahead of a moving target
local TURN_BACK = 8      -- metres from the middle; the arena's platform ends at 10 m

local function choose(bodies)
  for _, body in ipairs(bodies) do  -- sorted by distance
    if body.name then return body end
  end
  return bodies[1]
end

local function run_to(bot, x, y)
  local own_x, own_y = bot:position()
  local angle = math.atan(y - own_y, x - own_x)
  bot:move(math.cos(angle), math.sin(angle))
end

function run(bot)
  while true do
    local x, y = bot:position()
    local prey = x and choose(bot:near(SIGHT))
    if x and math.sqrt(x * x + y * y) > TURN_BACK then
      run_to(bot, 0, 0)
    elseif prey then
      run_to(bot, prey.x + LEAD * (prey.vx or 0), prey.y + LEAD * (prey.vy or 0))
      if prey.distance < LEAP and bot:random() < 0.3 then bot:jump() end
    else
      bot:move(0, 0)
    end
    bot:wait(0.1 + 0.1 * bot:random())  -- a person's reaction time
  end
end
