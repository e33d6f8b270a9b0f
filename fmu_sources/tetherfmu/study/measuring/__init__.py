"""What a run costs and how wrong it is: runs, references, errors, times, results on disk, tables. Imports `scenes`."""
