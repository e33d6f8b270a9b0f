"""Shared by all commands and examples: options, exit statuses, progress messages."""
