-- Plays goals: gets behind the ball, runs it towards the other side's goal and pushes it where it points there. Every
-- third bot keeps the goal. Load: a crowd round one large body, hard contact, and pushes.
local LINE = 14          -- metres from the middle to the goal line
local BEHIND = 1.9       -- metres behind the ball's centre from which it runs
local REACH = 1.9        -- metres from which it pushes
local KEEPS = 3          -- metres before the line where a keeper stands
local DANGER = 6         -- metres from the line at which a keeper goes for the ball

local function run_to(bot, x, y)
  local own_x, own_y = bot:position()
  local dx, dy = x - own_x, y - own_y
  local length = math.sqrt(dx * dx + dy * dy)
  local share = math.min(1, length)  -- slows down within the last metre
  if length > 0.1 then bot:move(share * dx / length, share * dy / length) else bot:move(0, 0) end
end

-- From (x, y), the unit vector to the goal at goal_x.
local function way_to_goal(x, y, goal_x)
  local dx, dy = goal_x - x, -y
  local length = math.max(0.1, math.sqrt(dx * dx + dy * dy))
  return dx / length, dy / length
end

local function attack(bot, ball, goal_x)
  local x, y = bot:position()
  local dx, dy = way_to_goal(ball.x, ball.y, goal_x)
  local from_x, from_y = ball.x - x, ball.y - y
  local ahead = from_x * dx + from_y * dy  -- how far behind the ball it is
  local aside = from_x * dy - from_y * dx
  if ahead < 0.6 then                      -- in front of the ball: round it, on the side where it is
    local turn = aside > 0 and -1.6 or 1.6
    run_to(bot, ball.x - dx * BEHIND + turn * dy, ball.y - dy * BEHIND - turn * dx)
  elseif math.abs(aside) > 0.8 then
    run_to(bot, ball.x - dx * BEHIND, ball.y - dy * BEHIND)
  else
    run_to(bot, ball.x + dx * 2, ball.y + dy * 2)
    if ball.distance < REACH and bot:random() < 0.5 then bot:push(ball.body, dx, dy, 0.25) end
  end
end

local function keep(bot, ball, own_x, goal_x)
  if math.abs(ball.x - own_x) < DANGER then return attack(bot, ball, goal_x) end
  local way = own_x < 0 and 1 or -1
  run_to(bot, own_x + way * KEEPS, math.max(-2.5, math.min(2.5, ball.y)))
end

function run(bot)
  while true do
    local game = bot:game()
    local ball = game and game.object
    if ball and game.side and bot:position() then
      local own_x = game.side == 1 and -LINE or LINE
      if bot:id() % 3 == 0 then keep(bot, ball, own_x, -own_x) else attack(bot, ball, -own_x) end
    else
      bot:move(0, 0)
    end
    bot:wait(0.1 + 0.1 * bot:random())  -- a person's reaction time
  end
end
