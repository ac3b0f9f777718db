-- Joins, stays a moment, leaves and joins again. Load: about one join per second and bot.
local STAY = { 0.2, 1.5 }  -- seconds of a stay, least and most
local AWAY = { 0, 1 }      -- seconds between stays

local function between(bot, range)
  return range[1] + (range[2] - range[1]) * bot:random()
end

function run(bot)
  while true do
    bot:move(bot:random() * 2 - 1, bot:random() * 2 - 1)
    bot:wait(between(bot, STAY))
    bot:leave()
    bot:wait(between(bot, AWAY))
    bot:join()
  end
end
