"""What a user types: the command `tetherfmu`, one module for each of its own subcommands."""
