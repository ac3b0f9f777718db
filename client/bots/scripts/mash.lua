-- Presses everything at random in every round, faster than a person can. Load: the worst case of inputs.
function run(bot)
  while true do
    bot:move(bot:random() * 2 - 1, bot:random() * 2 - 1)
    if bot:random() < 0.5 then bot:jump() end
    bot:puff(bot:random() < 0.5)
    bot:stiffen(bot:random() < 0.5)
    bot:wait(0)
  end
end
