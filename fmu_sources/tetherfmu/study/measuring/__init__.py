"""Cost and error of runs: runs, references, errors, times, results on disk, tables. Imports `scenes`."""
