-- Hops towards the middle of the world, and puffs itself up while it is in the air.
function run(bot)
  while true do
    local x, y, z = bot:position()
    if x then bot:move(-x / 4, -y / 4) end
    bot:puff(z ~= nil and z > 1)
    if bot:random() < 0.1 then bot:jump() end
    bot:wait(0.1)
  end
end
