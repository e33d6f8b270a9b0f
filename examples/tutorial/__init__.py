"""The lessons of the tutorial: scripts beside one another that import each other by their names, as for a script."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
