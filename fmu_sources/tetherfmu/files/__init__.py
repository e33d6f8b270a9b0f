"""Files that people write: scenes, systems, tables, settings of single values, and files of other programs."""
