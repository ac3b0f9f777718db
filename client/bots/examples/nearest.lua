-- Follows the nearest body and jumps now and then.
function run(bot)
  while true do
    local other = bot:near(10)[1]              -- the nearest body
    local x, y = bot:position()
    if x and other then bot:move(other.x - x, other.y - y) end
    if bot:random() < 0.1 then bot:jump() end
    bot:wait(0.2)
  end
end
