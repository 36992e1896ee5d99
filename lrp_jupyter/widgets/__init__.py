"""The lab: the anywidget that shows a session, and the magics. Paper: §6.5."""
