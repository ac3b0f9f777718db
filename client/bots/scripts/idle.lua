-- Joins and stands still. Load: a crowd of onlookers.
function run(bot)
end
