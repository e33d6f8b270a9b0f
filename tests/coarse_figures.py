"""Figures of tests are coarse and nothing in them makes room for labels: else drawing takes most of the time of a flight."""

PART = 1 / 3  # of the resolution


def draw_coarsely():
    """Save the figures of this process so; where matplotlib is missing there are none."""
    try:
        from matplotlib.figure import Figure
    except ImportError:
        return
    savefig = Figure.savefig

    def coarsely(self, *given, dpi=None, **options):
        if "format" not in options:  # frames of an animation have a size
            self.set_layout_engine("none")
            dpi = dpi and PART * dpi
        return savefig(self, *given, dpi=dpi, **options)

    Figure.savefig = coarsely
