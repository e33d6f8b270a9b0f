"""What users describe, as constant records with their checks: lines, points, winches, materials, paths."""
