-- Presses everything at random in every round, as nobody can: the worst that inputs can do to a server.
function run(bot)
  while true do
    bot:move(bot:random() * 2 - 1, bot:random() * 2 - 1)
    if bot:random() < 0.5 then bot:jump() end
    bot:puff(bot:random() < 0.5)
    bot:stiffen(bot:random() < 0.5)
    bot:wait(0)
  end
end
