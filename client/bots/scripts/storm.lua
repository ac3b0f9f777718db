-- Joins, stays a moment, leaves and comes again: what a server does for a player it does once a second and bot.
local STAY = { 0.2, 1.5 }  -- seconds in, least and most
local AWAY = { 0, 1 }      -- and out

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
