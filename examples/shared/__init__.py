"""What the folders share: FMUs are found, loaded and read by name; flights are drawn, and shown on pages in space.

`example_fmus` builds the FMUs of the folder `fmus`, `cache` keeps FMUs for the user, `ssp` makes systems of them."""
