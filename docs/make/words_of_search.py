"""Sphinx extension: what the search and the index of the site find: words of readers, and no modules of the kernels.

A word of `WORDS` leads to its place first, whether the page has the word or not. The functions of the kernels are found from
the pages of equations, which have links to them.
"""

from docutils import nodes
from sphinx import addnodes
from sphinx.domains.python import PythonDomain
from sphinx.transforms import SphinxTransform
from sphinx.util import logging

HIDDEN, KERNELS = "contributors/functions", "tetherfmu.kernels."  # page, and how the names of its objects begin
WORDS = {  # page#section: what a reader may type
    "course/01_fly_an_fmu": ("notebook", "Jupyter", "example", "course", "tutorial"),
    "contributors/developing#release": ("publish", "wheel"),
    "measurements/benchmarks": ("speed", "performance"),
    "measurements/measured_flights": ("experiment",),
    "measurements/validation": ("verification", "accuracy"),
    "models/theory#elastic-catenary": ("sag",),
    "models/theory#one-segment": ("lumped mass", "spring-damper"),
    "reference/api": ("Python",),
    "reference/api#turbulence": ("turbulence", "gusts"),
    "reference/promises": ("semantic versioning", "compatibility", "deprecation"),
    "reference/commands": ("command line", "terminal", "options"),
    "reference/variables#parameters": ("elastic modulus", "Young's modulus", "stiffness", "material", "density"),
    "use/coupling#a-policy-that-steers-gymnasium": ("reinforcement learning",),
    "use/cranes_and_drones": ("crane", "hoist", "drone", "UAV", "cable", "rope"),
    "use/comparison": ("alternatives", "OrcaFlex"),
    "use/example_fmus": ("pumping cycle", "controller"),
    "use/faq": ("questions", "FAQ"),
    "use/gallery": ("pictures",),
    "use/ground": ("friction", "seabed", "landing"),
    "use/how_much_tether": ("segments", "fidelity", "tolerance"),
    "use/scene_files": ("scene", "TOML"),
    "use/importing": ("host", "native"),
    "use/importing#dymola-not-tested": ("Dymola",),
    "use/importing#fmpy-tested": ("FMPy",),
    "use/importing#openmodelica-not-tested": ("OpenModelica", "OMEdit"),
    "use/importing#simulink-not-tested": ("MATLAB", "Simulink"),
    "use/in_the_browser": ("browser", "WebAssembly"),
    "use/interface#breaking-and-letting-go": ("breaking", "rupture", "release", "weak link"),
    "use/interface#the-winch": ("winch", "drum", "reel in", "reel out", "reeling"),
    "use/real_time": ("hardware in the loop", "HIL"),
    "use/start": ("install", "installation", "download", "clone"),
    "use/start#how-to-cite": ("citation", "cite", "BibTeX"),
    "use/sweeps": ("parameter study", "batch"),
    "use/systems": ("bridle", "MoorDyn", "network"),
    "use/systems#a-winch-that-holds-several-lines": ("steering tapes", "several lines"),
    "use/systems#lines-over-sheaves": ("sheave", "pulley", "hook block", "reeving", "fairlead", "block and tackle"),
    "use/tutorial": ("Tethers.jl lessons", "mass on a spring"),
    "use/your_log": ("replay", "flight log", "CSV"),
}
PLACES = {place: place.partition("#")[::2] for place in WORDS}  # page#section -> (page, section)


class Entries(SphinxTransform):
    """Add the words to a page as entries of the index, and remove those of the kernels."""

    default_priority = 840  # before Sphinx reads the entries

    def apply(self, **_):
        """Do both on one page."""
        page = self.env.current_document.docname
        if page == HIDDEN:
            for entry in list(self.document.findall(addnodes.index)):
                entry.parent.remove(entry)
        for place, (where, section) in PLACES.items():
            if where == page:
                target = section or next(self.document.findall(nodes.section))["ids"][0]
                if target not in self.document.ids:
                    logging.getLogger(__name__).warning("words_of_search: %s has no section %s", page, target)
                entries = [("single", word, target, "main", None) for word in WORDS[place]]
                self.document.insert(0, addnodes.index(entries=entries, inline=False))


class Searched(PythonDomain):
    """Objects of Python, those of the kernels without a place in the search."""

    def get_objects(self):
        """Name, shown name, kind, page, anchor and priority of each; a negative priority hides it."""
        for name, *others, priority in super().get_objects():
            yield (name, *others, -1 if f"{name}.".startswith(KERNELS) else priority)


def unsearched(app, env):
    """Leave the words of the page of the kernels out of the search."""
    env.metadata[HIDDEN]["nosearch"] = True


def setup(app):
    """Connect all."""
    app.add_transform(Entries)
    app.add_domain(Searched, override=True)
    app.connect("env-updated", unsearched)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
