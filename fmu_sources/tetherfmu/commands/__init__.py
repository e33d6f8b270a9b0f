"""The command `tetherfmu`, with one module for each subcommand of the package."""
