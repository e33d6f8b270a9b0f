"""What users give beside a system itself, with checks: materials, paths, arguments; whether a system fits together."""
