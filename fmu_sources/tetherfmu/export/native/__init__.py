"""Native FMUs: no Python in them. Their tables in C, model descriptions, sources, and the header for hosts."""
