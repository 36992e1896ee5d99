-- Does in Neovim what a person does, and writes what is shown into the file $LRP_TOLD.
local told = {}
local function tell()
  vim.fn.writefile({ vim.fn.json_encode(told) }, vim.env.LRP_TOLD)
  vim.cmd('qa!')
end
local function wait(what, holds)
  if not vim.wait(60000, holds, 20) then
    told.missing = what
    tell()
  end
end
local function text() return table.concat(vim.api.nvim_buf_get_lines(0, 0, -1, false), '\n') end

wait('findings', function() return #vim.diagnostic.get(0) > 0 end)
told.codes = vim.tbl_map(function(each) return each.code end, vim.diagnostic.get(0))

vim.ui.select = function(items, _, choose) told.fixes = #items; choose(items[1], 1) end
vim.fn.search('turnin)')
vim.lsp.buf.code_action()
wait('the fix', function() return #vim.diagnostic.get(0) == 0 end)

vim.fn.search('move(')
vim.lsp.buf.hover()
wait('the explanation', function() return #vim.api.nvim_list_wins() > 1 end)
for _, window in ipairs(vim.api.nvim_list_wins()) do
  if vim.api.nvim_win_get_config(window).relative ~= '' then
    told.hover = table.concat(vim.api.nvim_buf_get_lines(vim.api.nvim_win_get_buf(window), 0, -1, false), '\n')
    vim.api.nvim_win_close(window, true)
  end
end

vim.fn.search('driving -> turning')
vim.lsp.buf.rename('rolling')
wait('the new name', function() return text():find('rolling %-> turning') end)

vim.api.nvim_buf_set_lines(0, 0, 1, false, { '(var   pace  :=   [0.2])' })
vim.cmd('LrpFormat')
wait('the layout', function() return text():find('(var pace := [0.2])', 1, true) end)
told.text = text()

-- completion is shown while one writes: the rest happens in insert mode
vim.fn.search('rolling -> t', 'e')
vim.api.nvim_feedkeys(vim.api.nvim_replace_termcodes('a<C-x><C-o>', true, false, true), 'n', false)
local timer = vim.loop.new_timer()
timer:start(20, 20, vim.schedule_wrap(function()
  local found = vim.fn.complete_info({ 'items' }).items or {}
  if #found == 0 then return end
  timer:stop()
  told.completion = vim.tbl_map(function(each) return each.word end, found)
  tell()
end))
vim.defer_fn(function() told.missing = 'completion'; tell() end, 60000)
