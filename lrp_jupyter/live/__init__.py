"""The live shell around the interpreter: time, thread, commands, frames. Paper: §6."""
