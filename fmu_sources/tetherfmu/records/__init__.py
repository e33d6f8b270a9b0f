"""What users give beside a system itself, with its checks: materials, paths, arguments; and whether a system fits together."""
