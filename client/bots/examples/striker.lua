-- Plays goals: runs at the ball, and pushes it towards the other side's goal when it is near.
function run(bot)
  while true do
    local game = bot:game()
    local x, y = bot:position()
    local ball = game and game.object
    if x and ball then
      bot:move(ball.x - x, ball.y - y)
      if ball.distance < 2 then bot:push(ball.body, game.side == 1 and 1 or -1, 0, 0.3) end
    end
    bot:wait(0.2)
  end
end
