-- Joins and stands still: what a crowd of onlookers costs the server.
function run(bot)
end
