-- LRP in Neovim, 0.7 or newer. Put this file into ~/.config/nvim/after/plugin/, not plugin/: it must come after
-- the plugin that takes *.lrp for archives of the Linux Router Project.
--
-- Findings with fixes, completion (Ctrl-X Ctrl-O), and the keys of Neovim 0.11: K explains, grn renames,
-- gra offers fixes, grr finds uses, gd goes to the definition, gO lists what there is; :LrpFormat lays out.
-- While `lrp run FILE --watch --socket` runs, values are shown at the ends of lines.

local hints = vim.api.nvim_create_namespace('lrp_live')
vim.cmd('highlight default link LrpLive DiagnosticInfo')
local has_own_hints = vim.lsp.inlay_hint ~= nil -- since 0.10
local client_id

-- Values at the ends of lines, where Neovim itself shows no inlay hints.
local function show_hints(client)
  for buffer in pairs(vim.lsp.get_client_by_id(client).attached_buffers or {}) do
    local params = {
      textDocument = vim.lsp.util.make_text_document_params(buffer),
      range = {
        start = { line = 0, character = 0 },
        ['end'] = { line = vim.api.nvim_buf_line_count(buffer), character = 0 },
      },
    }
    vim.lsp.get_client_by_id(client).request('textDocument/inlayHint', params, function(_, result)
      if not vim.api.nvim_buf_is_loaded(buffer) then return end
      vim.api.nvim_buf_clear_namespace(buffer, hints, 0, -1)
      for _, hint in ipairs(result or {}) do
        local virtual = { virt_text = { { ' ' .. hint.label, 'LrpLive' } }, virt_text_pos = 'eol' }
        pcall(vim.api.nvim_buf_set_extmark, buffer, hints, hint.position.line, 0, virtual)
      end
    end, buffer)
  end
end

local function configuration(buffer)
  local capabilities = vim.lsp.protocol.make_client_capabilities()
  local handlers = {}
  if not has_own_hints then
    capabilities.workspace.inlayHint = { refreshSupport = true }
    handlers['workspace/inlayHint/refresh'] = function(_, _, context)
      show_hints(context.client_id)
      return vim.NIL
    end
  end
  return {
    name = 'lrp',
    cmd = { "lrp", 'language-server' },
    root_dir = vim.fn.fnamemodify(vim.api.nvim_buf_get_name(buffer), ':p:h'),
    capabilities = capabilities,
    handlers = handlers,
  }
end

local function attach(buffer)
  if vim.lsp.start then -- since 0.8
    vim.lsp.start(configuration(buffer), { bufnr = buffer })
  else
    if not client_id or not vim.lsp.get_client_by_id(client_id) then
      client_id = vim.lsp.start_client(configuration(buffer))
    end
    if client_id then vim.lsp.buf_attach_client(buffer, client_id) end
  end
  if has_own_hints then vim.lsp.inlay_hint.enable(true, { bufnr = buffer }) end
end

local function set_up(buffer)
  vim.bo[buffer].commentstring = '# %s'
  vim.bo[buffer].omnifunc = 'v:lua.vim.lsp.omnifunc'
  vim.bo[buffer].expandtab = true
  vim.bo[buffer].shiftwidth = 2
  vim.bo[buffer].lisp = true
  local keys = {
    K = vim.lsp.buf.hover,
    gd = vim.lsp.buf.definition,
    grn = vim.lsp.buf.rename,
    gra = vim.lsp.buf.code_action,
    grr = vim.lsp.buf.references,
    gO = vim.lsp.buf.document_symbol,
  }
  for key, action in pairs(keys) do
    vim.keymap.set('n', key, function() action() end, { buffer = buffer })
  end
  vim.api.nvim_buf_create_user_command(buffer, 'LrpFormat', function()
    if vim.lsp.buf.format then vim.lsp.buf.format() else vim.lsp.buf.formatting_sync() end
  end, {})
  attach(buffer)
end

-- Colours: of the language, and of Python in its blocks.
local function colour()
  vim.cmd([[
    syntax clear
    syntax include @lrpPython syntax/python.vim
    syntax match lrpComment /[;#].*$/
    syntax match lrpKeyword /(\s*\zs\(var\|machine\|state\|event\|spawn\|onentry\|running\|onexit\|on\|ontime\|eps\|exit\|effect\|onpause\|onresume\|onend\)\>/
    syntax match lrpOperator /->\|:=\|\*/
    syntax match lrpNumber /\<\d\+\>/
    syntax region lrpBlock matchgroup=Delimiter start=/\[/ end=/\]/ contains=@lrpPython,lrpBlock
    highlight default link lrpComment Comment
    highlight default link lrpKeyword Keyword
    highlight default link lrpOperator Operator
    highlight default link lrpNumber Number
  ]])
end

for _, event in ipairs({ 'BufReadCmd', 'FileReadCmd' }) do
  pcall(vim.cmd, 'autocmd! tar ' .. event .. ' *.lrp')
end
local group = vim.api.nvim_create_augroup('lrp', { clear = true })
vim.api.nvim_create_autocmd({ 'BufRead', 'BufNewFile' }, {
  group = group,
  pattern = '*.lrp',
  callback = function() vim.bo.filetype = 'lrp' end,
})
vim.api.nvim_create_autocmd('FileType', {
  group = group,
  pattern = 'lrp',
  callback = function(event) set_up(event.buf) end,
})
vim.api.nvim_create_autocmd('Syntax', {
  group = group,
  pattern = 'lrp',
  callback = function(event)
    vim.schedule(function() -- after Neovim's own, which clears what there is
      if vim.api.nvim_buf_is_loaded(event.buf) then vim.api.nvim_buf_call(event.buf, colour) end
    end)
  end,
})
